// SPDX-License-Identifier: MIT
// The camera of the view in space, without perspective, and the hands that move it: mouse, touch,
// wheel, keyboard.

// Where one looks from: a turn, the point in the middle of the view, and half the height seen.
class Camera {
  constructor(box) {
    this.box = box;
    this.three = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
    this.turn = new THREE.Quaternion();
    this.target = new THREE.Vector3();
    this.half = 1;
    this.aspect = 1;
    this.kept = 0;  // part of the width, on the right, that is kept free for the legend
    this.up = new THREE.Vector3(0, 0, 1);
    this.corners = [];
    for (let i = 0; i < 8; ++i) {
      this.corners.push(new THREE.Vector3(...[0, 1, 2].map((k) => ((i >> k) & 1 ? box.high : box.low)[k])));
    }
    const middle = new THREE.Vector3();
    this.corners.forEach((c) => middle.addScaledVector(c, 1 / 8));
    this.middle = middle;
    this.radius = Math.max(1e-12, ...this.corners.map((c) => c.distanceTo(middle)));
  }

  // Looks from `direction` (towards the eye) with `up` upwards, all of the box in view.
  look(direction, up) {
    this.up.copy(up).normalize();
    const z = direction.clone().normalize();
    const x = new THREE.Vector3().crossVectors(up, z).normalize();
    const y = new THREE.Vector3().crossVectors(z, x);
    this.turn.setFromRotationMatrix(new THREE.Matrix4().makeBasis(x, y, z));
    this.fit();
  }

  axis(k) {
    return new THREE.Vector3(k === 0 ? 1 : 0, k === 1 ? 1 : 0, k === 2 ? 1 : 0).applyQuaternion(this.turn);
  }

  // All of the box in view, in the middle.
  fit() {
    const right = this.axis(0), up = this.axis(1);
    const xs = this.corners.map((c) => c.dot(right)), ys = this.corners.map((c) => c.dot(up));
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    this.target.copy(this.middle);
    this.target.addScaledVector(right, (x0 + x1) / 2 - this.middle.dot(right));
    this.target.addScaledVector(up, (y0 + y1) / 2 - this.middle.dot(up));
    this.half = Math.max((y1 - y0) / 2 * 1.14, (x1 - x0) / 2 * 1.1 / (this.aspect * (1 - this.kept)), this.radius * 1e-3);
    this.target.addScaledVector(right, this.half * this.aspect * this.kept);
  }

  // What three.js draws with.
  update() {
    const c = this.three;
    const far = 8 * this.radius + this.target.distanceTo(this.middle);
    c.left = -this.half * this.aspect;
    c.right = this.half * this.aspect;
    c.top = this.half;
    c.bottom = -this.half;
    c.near = 0;
    c.far = 2 * far;
    c.quaternion.copy(this.turn);
    c.position.copy(this.target).addScaledVector(this.axis(2), far);
    c.updateProjectionMatrix();
    c.updateMatrixWorld();
    return c;
  }

  // Turns about what was upwards at first, so that upright parts stay upright, and about the screen's
  // horizontal. Upside down, the hand still pulls the side that it sees.
  rotate(aboutUp, aboutRight) {
    const q = new THREE.Quaternion();
    const sign = this.axis(1).dot(this.up) < 0 ? -1 : 1;
    this.turn.premultiply(q.setFromAxisAngle(this.up, sign * aboutUp));
    this.turn.multiply(q.setFromAxisAngle(new THREE.Vector3(1, 0, 0), aboutRight)).normalize();
  }

  // Moves by parts of the view's height.
  pan(x, y) {
    this.target.addScaledVector(this.axis(0), -2 * this.half * x);
    this.target.addScaledVector(this.axis(1), 2 * this.half * y);
  }

  // Zooms, keeping what is at (x, y), in parts of the view's height from its middle.
  zoom(factor, x = 0, y = 0) {
    const half = Math.min(this.radius * 20, Math.max(this.radius * 1e-4, this.half / factor));
    const kept = this.half - half;
    this.target.addScaledVector(this.axis(0), 2 * kept * x);
    this.target.addScaledVector(this.axis(1), -2 * kept * y);
    this.half = half;
  }
}

// Calls rotate(dx, dy), pan(dx, dy), zoom(factor, x, y), point(x, y), tap(x, y), leave() with pixels of
// `element`, and key(name) for keys that mean something to a view. Returns nothing; listens for good.
function listenToHands(element, hands) {
  const pointers = new Map();
  let moved = 0;
  const at = (event) => {
    const r = element.getBoundingClientRect();
    return [event.clientX - r.left, event.clientY - r.top];
  };
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, d: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  element.addEventListener("pointerdown", (event) => {
    const [x, y] = at(event);
    if (pointers.size === 0) moved = 0;
    pointers.set(event.pointerId, { x, y, button: event.button });
    try {
      element.setPointerCapture(event.pointerId);
    } catch (gone) {
      // A pointer that has already left needs no capture.
    }
    hands.leave();
  });
  element.addEventListener("pointermove", (event) => {
    const [x, y] = at(event);
    const p = pointers.get(event.pointerId);
    if (!p) {
      if (event.pointerType !== "touch") hands.point(x, y);
      return;
    }
    const dx = x - p.x, dy = y - p.y;
    moved += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 1) {
      p.x = x;
      p.y = y;
      if (p.button !== 0 || event.shiftKey || event.ctrlKey) {
        hands.pan(dx, dy);
      } else {
        hands.rotate(dx, dy);
      }
    } else if (pointers.size === 2) {
      const before = spread();
      p.x = x;
      p.y = y;
      const after = spread();
      hands.pan(after.x - before.x, after.y - before.y);
      if (before.d > 8 && after.d > 8) hands.zoom(after.d / before.d, after.x, after.y);
    }
  });
  const release = (event) => {
    const [x, y] = at(event);
    const p = pointers.get(event.pointerId);
    pointers.delete(event.pointerId);
    if (p && event.type === "pointerup" && pointers.size === 0 && moved < 6) hands.tap(x, y);
    if (pointers.size > 0) moved = 100;
  };
  element.addEventListener("pointerup", release);
  element.addEventListener("pointercancel", release);
  element.addEventListener("pointerleave", () => { if (pointers.size === 0) hands.leave(); });
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1;
    const amount = Math.max(-240, Math.min(240, event.deltaY * lines));
    hands.leave();
    hands.zoom(Math.exp(-amount * (event.ctrlKey ? 0.01 : 0.0016)), ...at(event));
  }, { passive: false });
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const step = steps[event.key];
    const { width, height } = element.getBoundingClientRect();
    if (step) {
      const [dx, dy] = step.map((s) => s * 28);
      if (event.shiftKey) {
        hands.pan(dx, dy);
      } else {
        hands.rotate(dx, dy);
      }
    } else if (event.key === "+" || event.key === "=") {
      hands.zoom(1.2, width / 2, height / 2);
    } else if (event.key === "-") {
      hands.zoom(1 / 1.2, width / 2, height / 2);
    } else if (!hands.key(event.key)) {
      return;
    }
    event.preventDefault();
  });
}
