// SPDX-License-Identifier: MIT
// Lines of any width in the view in space: WebGL itself draws them one pixel wide. Every piece of a
// line is a rectangle of four corners that the shader spreads across the screen.

const kLineVertexShader = `
  attribute vec3 other;  // the piece's other end
  attribute float side;
  uniform vec2 half_view;  // of the canvas, in pixels
  uniform float width, lift;
  void main() {
    vec4 here = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    vec4 there = projectionMatrix * modelViewMatrix * vec4(other, 1.0);
    vec2 along = (there.xy - here.xy) * half_view;
    float length_seen = length(along);
    along = length_seen > 1e-6 ? along / length_seen : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x) * side;
    gl_Position = here;
    gl_Position.xy += (across - along) * 0.5 * width / half_view;
    gl_Position.z -= lift;
  }`;

const kLineFragmentShader = `
  precision highp float;
  uniform vec3 colour;
  uniform float opacity;
  void main() { gl_FragColor = vec4(colour, opacity); }`;

function lineMaterial({ colour, width, lift, opacity = 1 }) {
  return new THREE.ShaderMaterial({
    vertexShader: kLineVertexShader,
    fragmentShader: kLineFragmentShader,
    side: THREE.DoubleSide,
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    uniforms: {
      colour: { value: new THREE.Color(colour) }, opacity: { value: opacity }, width: { value: width },
      lift: { value: lift }, half_view: { value: new THREE.Vector2(1, 1) },
    },
  });
}

// One object of all pieces between neighbours of the polylines [x, y, z, x, y, z, …].
function linesObject(polylines, options) {
  let pieces = 0;
  for (const p of polylines) pieces += Math.max(0, p.length / 3 - 1);
  const position = new Float32Array(12 * pieces), other = new Float32Array(12 * pieces);
  const side = new Float32Array(4 * pieces), index = new Uint32Array(6 * pieces);
  let k = 0;
  for (const p of polylines) {
    for (let i = 0; i + 5 < p.length; i += 3, ++k) {
      for (let c = 0; c < 4; ++c) {
        const here = c < 2 ? i : i + 3, there = c < 2 ? i + 3 : i;
        for (let d = 0; d < 3; ++d) {
          position[12 * k + 3 * c + d] = p[here + d];
          other[12 * k + 3 * c + d] = p[there + d];
        }
        side[4 * k + c] = c === 0 || c === 3 ? 1 : -1;
      }
      index.set([0, 1, 3, 0, 3, 2].map((c) => 4 * k + c), 6 * k);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  geometry.setAttribute("other", new THREE.BufferAttribute(other, 3));
  geometry.setAttribute("side", new THREE.BufferAttribute(side, 1));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  const object = new THREE.Mesh(geometry, lineMaterial(options));
  object.frustumCulled = false;
  return object;
}

// Rows and columns of a control net, or the polygon of a curve.
function netLines(net) {
  const [n, m = 1] = net.size;
  const lines = [];
  const at = (i, j) => net.points.subarray(3 * (i * m + j), 3 * (i * m + j) + 3);
  const line = (length, place) => {
    const p = new Float32Array(3 * length);
    for (let i = 0; i < length; ++i) p.set(place(i), 3 * i);
    lines.push(p);
  };
  if (m === 1) {
    line(n, (i) => at(i, 0));
    return lines;
  }
  for (let i = 0; i < n; ++i) line(m, (j) => at(i, j));
  for (let j = 0; j < m; ++j) line(n, (i) => at(i, j));
  return lines;
}
