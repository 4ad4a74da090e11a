// SPDX-License-Identifier: MIT
// The shaders of the view in space: surfaces coloured by a value, plain, or striped like a zebra; and
// points. The eye looks without perspective, so that in its frame the view direction is (0, 0, 1).

const kSurfaceVertexShader = `
  attribute vec2 value;  // (value where known, 1 where known): both 0 where none is
  varying vec2 vValue;
  varying vec3 vNormal;
  void main() {
    vValue = value;
    vNormal = normalMatrix * normal;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

const kSurfaceFragmentShader = `
  #extension GL_OES_standard_derivatives : enable
  precision highp float;
  uniform int mode;  // 0 plain, 1 by value, 2 zebra
  uniform sampler2D table;
  uniform float limit, stripes, dot_size;
  varying vec2 vValue;
  varying vec3 vNormal;
  void main() {
    vec3 n = length(vNormal) > 1e-6 ? normalize(vNormal) : vec3(0.0, 0.0, 1.0);
    if (n.z < 0.0) n = -n;  // both sides alike
    if (mode == 2) {
      // Bright tubes in a dark room, reflected: where the mirrored ray points decides the colour.
      vec3 ray = 2.0 * n.z * n - vec3(0.0, 0.0, 1.0);
      float phase = asin(clamp(ray.y * 0.999, -1.0, 1.0)) / 3.14159265 * stripes;
      float wave = abs(fract(phase) - 0.5) * 2.0;
      float blur = max(1e-4, 2.0 * fwidth(phase));
      float bright = blur > 1.5 ? 0.5 : smoothstep(0.5 - 0.5 * blur, 0.5 + 0.5 * blur, wave);
      float rim = 0.75 + 0.25 * n.z;
      gl_FragColor = vec4(mix(vec3(0.10, 0.11, 0.13), vec3(0.97), bright) * rim, 1.0);
      return;
    }
    float key = max(0.0, dot(n, normalize(vec3(-0.45, 0.55, 0.75))));
    if (mode == 0) {
      float fill = max(0.0, dot(n, normalize(vec3(0.7, -0.2, 0.5))));
      float shine = pow(max(0.0, dot(n, normalize(vec3(-0.25, 0.32, 0.95)))), 60.0);
      vec3 base = vec3(0.70, 0.745, 0.79);
      gl_FragColor = vec4(base * (0.34 + 0.62 * key + 0.16 * fill) + 0.16 * shine, 1.0);
      return;
    }
    vec3 colour;
    if (vValue.y < 0.5) {
      float line = mod(gl_FragCoord.x + gl_FragCoord.y, 9.0 * dot_size);
      colour = line < 1.6 * dot_size ? vec3(0.52, 0.525, 0.53) : vec3(0.66, 0.667, 0.678);
    } else {
      float t = clamp(vValue.x / vValue.y / limit, -1.24, 1.24);
      colour = texture2D(table, vec2(0.5 + 0.5 * t / 1.25, 0.5)).rgb;
    }
    gl_FragColor = vec4(colour * (0.74 + 0.28 * key), 1.0);
  }`;

const kPointVertexShader = `
  attribute vec2 value;
  uniform float size, lift;
  varying vec2 vValue;
  void main() {
    vValue = value;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_Position.z -= lift;
    gl_PointSize = size;
  }`;

// Round points by value, or marks of one colour: 1 a cross, 2 a disc, 3 a diamond.
const kPointFragmentShader = `
  precision highp float;
  uniform int mark;
  uniform sampler2D table;
  uniform vec3 colour;
  uniform float limit, size;
  varying vec2 vValue;
  void main() {
    vec2 p = 2.0 * gl_PointCoord - 1.0;
    if (mark == 1) {
      float arm = min(abs(p.x - p.y), abs(p.x + p.y));
      if (arm > 0.5 || max(abs(p.x), abs(p.y)) > 0.98) discard;
      gl_FragColor = vec4(arm > 0.27 ? vec3(1.0) : colour, 1.0);
      return;
    }
    if (mark == 3) {
      float d = abs(p.x) + abs(p.y);
      if (d > 1.0) discard;
      gl_FragColor = vec4(d > 0.62 ? colour : vec3(1.0), 1.0);
      return;
    }
    float r = dot(p, p);
    if (r > 1.0) discard;
    if (mark == 2) {
      gl_FragColor = vec4(colour, 1.0);
      return;
    }
    vec3 c = vec3(0.66, 0.667, 0.678);
    if (vValue.y > 0.5) {
      float t = clamp(vValue.x / limit, -1.24, 1.24);
      c = texture2D(table, vec2(0.5 + 0.5 * t / 1.25, 0.5)).rgb;
    }
    // A rim sets pale points off from white paper.
    gl_FragColor = vec4(size > 3.5 && r > 0.5 ? c * 0.72 : c, 1.0);
  }`;

function textureOf(map) {
  const texture = new THREE.DataTexture(colourTable(map), kTableSize, 1, THREE.RGBAFormat);
  texture.magFilter = THREE.NearestFilter;
  texture.minFilter = THREE.NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

function surfaceMaterial(table, limit) {
  return new THREE.ShaderMaterial({
    vertexShader: kSurfaceVertexShader,
    fragmentShader: kSurfaceFragmentShader,
    side: THREE.DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 2,
    uniforms: {
      mode: { value: 1 }, table: { value: table }, limit: { value: limit },
      stripes: { value: 24 }, dot_size: { value: 1 },
    },
  });
}

function pointMaterial(table, limit, { mark = 0, colour = 0x000000, size = 3, lift = 0, through = false } = {}) {
  return new THREE.ShaderMaterial({
    depthTest: !through,
    transparent: through,  // drawn last
    vertexShader: kPointVertexShader,
    fragmentShader: kPointFragmentShader,
    uniforms: {
      mark: { value: mark }, table: { value: table }, limit: { value: limit },
      colour: { value: new THREE.Color(colour) }, size: { value: size }, lift: { value: lift },
    },
  });
}

// Pairs (value, 1), or (0, 0) where the value is not a number: shaders need not know NaN.
function knownValues(values, n) {
  const pairs = new Float32Array(2 * n);
  for (let i = 0; i < Math.min(n, values.length); ++i) {
    const v = values[i];
    if (v - v !== 0) continue;
    pairs[2 * i] = v;
    pairs[2 * i + 1] = 1;
  }
  return pairs;
}
