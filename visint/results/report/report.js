"use strict";
// The report's one script. It lays the reference view beneath maps, with a slider between the two, and draws
// the surface in three dimensions. The page says all it has to say without it; it asks for nothing and keeps nothing.

const view = document.getElementById("reference-view");

function made(tag, attributes, ...parts) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...parts);
  return element;
}

// ---- Sliders ----------------------------------------------------------------------------------------------

const SLIDERS = {
  swipe: { says: "photograph", start: 100, set: (map, under, share) => (map.style.clipPath = `inset(0 ${100 - share}% 0 0)`) },
  fade: { says: "photograph", start: 60, set: (map, under, share) => (under.style.opacity = share / 100) },
};

function alike(a, b) {
  const difference = a.naturalWidth * b.naturalHeight - b.naturalWidth * a.naturalHeight;
  return Math.abs(difference) <= 0.02 * a.naturalWidth * b.naturalHeight;
}

async function layOver(figure) {
  const map = figure.querySelector("img");
  await Promise.all([map.decode(), view.decode()]);
  if (!alike(map, view)) return;
  const { start, set } = SLIDERS[figure.dataset.over];
  const under = made("img", { src: view.src, alt: "", class: "under" });
  const stack = made("div", { class: "stack" });
  map.before(stack);
  stack.append(under, map);
  const title = figure.querySelector("figcaption strong").textContent;
  const fading = figure.dataset.over === "fade";
  const slider = made("input", { type: "range", min: 0, max: 100, step: 1, value: start });
  const label = made("label", { class: "slider" }, fading ? "photograph" : title, slider);
  slider.setAttribute("aria-label", fading ? `How much of the photograph is seen beneath ${title}` : `How much of ${title} is seen over the photograph`);
  slider.addEventListener("input", () => set(map, under, Number(slider.value)));
  set(map, under, start);
  stack.after(label);
}

if (view) for (const figure of document.querySelectorAll("figure[data-over]")) layOver(figure).catch(() => {});

// ---- The surface ------------------------------------------------------------------------------------------

const VERTEX = `#version 300 es
in vec3 place; in vec3 normal; in vec2 spot;
uniform mat3 turn; uniform vec3 middle; uniform float near; uniform vec2 lens; uniform float radius;
out vec3 facing; out vec3 own; out vec2 texel;
void main() {
  vec3 seen = turn * (place - middle) * vec3(1.0, -1.0, -1.0);
  facing = turn * normal * vec3(1.0, -1.0, -1.0);
  own = normal; texel = spot;
  float depth = near - seen.z;
  float front = max(near - 4.0 * radius, 0.02 * radius), back = near + 4.0 * radius;
  gl_Position = vec4(seen.xy * lens, (depth * (back + front) - 2.0 * back * front) / (back - front), depth);
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 facing; in vec3 own; in vec2 texel;
uniform sampler2D photograph; uniform int mode;
out vec4 colour;
void main() {
  vec3 unit = normalize(facing);
  float light = abs(unit.z) * 0.8 + 0.2 * max(0.0, dot(unit, normalize(vec3(-0.5, 0.7, 0.6))));
  vec3 normals = normalize(own) * vec3(0.5, -0.5, -0.5) + 0.5;
  vec3 painted = mode == 0 ? texture(photograph, texel).rgb : mode == 1 ? vec3(0.25 + 0.65 * light) : normals;
  colour = vec4(painted, 1.0);
}`;

// Turns are applied in the camera's frame (x right, y down, z forward); GL's y and z point the other way.

function heights(grid, text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const words = new Uint16Array(bytes.buffer);
  const scale = (grid.high - grid.low) / 65533;
  return Float32Array.from(words, (word) => (word ? grid.low + scale * (word - 1) : NaN));
}

function points(grid, values) {
  const places = new Float32Array(3 * values.length), spots = new Float32Array(2 * values.length);
  values.forEach((value, at) => {
    const u = (at % grid.columns) * grid.step, v = Math.floor(at / grid.columns) * grid.step;
    const z = grid.model === "perspective" ? 1 / value : value;
    const across = grid.model === "perspective" ? z / grid.f : 1;
    places.set([(u - grid.cx) * across, (v - grid.cy) * across, z], 3 * at);
    spots.set([(u + 0.5) / grid.width, (v + 0.5) / grid.height], 2 * at);
  });
  return { places, spots };
}

function triangles(grid, values) {
  const found = [];
  const torn = (corners) => {
    const some = corners.map((at) => values[at]);
    const low = Math.min(...some), high = Math.max(...some);
    if (Number.isNaN(low)) return true;
    return high - low > grid.tear * grid.step ** 0.5 * (grid.model === "perspective" ? low : grid.high - grid.low);
  };
  for (let row = 0; row + 1 < grid.rows; row++)
    for (let column = 0; column + 1 < grid.columns; column++) {
      const a = row * grid.columns + column, b = a + 1, c = a + grid.columns, d = c + 1;
      for (const corners of [[a, c, b], [b, c, d]]) if (!torn(corners)) found.push(...corners);
    }
  return new Uint32Array(found);
}

function normalsOf(places, corners) {
  const normals = new Float32Array(places.length);
  const point = (at) => places.subarray(3 * at, 3 * at + 3);
  for (let k = 0; k < corners.length; k += 3) {
    const [p, q, r] = [point(corners[k]), point(corners[k + 1]), point(corners[k + 2])];
    const [ax, ay, az, bx, by, bz] = [q[0] - p[0], q[1] - p[1], q[2] - p[2], r[0] - p[0], r[1] - p[1], r[2] - p[2]];
    const across = [by * az - bz * ay, bz * ax - bx * az, bx * ay - by * ax];
    for (let j = 0; j < 3; j++) across.forEach((value, axis) => (normals[3 * corners[k + j] + axis] -= value));
  }
  return normals;
}

// Middle and radius of the points that are drawn: the middle of the middle 96 % on each axis.
function bounds(places, corners) {
  const middle = [], extents = [];
  for (let axis = 0; axis < 3; axis++) {
    const sorted = Float32Array.from(corners, (at) => places[3 * at + axis]).sort();
    const low = sorted[Math.floor(0.02 * (sorted.length - 1))], high = sorted[Math.floor(0.98 * (sorted.length - 1))];
    middle.push((low + high) / 2);
    extents.push(high - low);
  }
  return { middle, radius: Math.hypot(...extents) / 2 || 1 };
}

function program(gl) {
  const whole = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(whole, shader);
  }
  gl.linkProgram(whole);
  if (!gl.getProgramParameter(whole, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(whole));
  gl.useProgram(whole);
  return whole;
}

function upload(gl, whole, mesh) {
  for (const [name, data, size] of [["place", mesh.places, 3], ["normal", mesh.normals, 3], ["spot", mesh.spots, 2]]) {
    const at = gl.getAttribLocation(whole, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.corners, gl.STATIC_DRAW);
}

function photograph(gl) {
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, view);
  gl.generateMipmap(gl.TEXTURE_2D);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
}

function turned(yaw, pitch) {
  const [c, s, d, t] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return [c, s * t, -s * d, 0, d, t, s, -c * t, c * d]; // columns of Rx(pitch) Ry(yaw)
}

const START = { yaw: 0.45, pitch: -0.25, away: 1.6 };
const OPENING = 2.1; // 1 / tan of half the angle of view

function painter(gl, mesh, pose) {
  const whole = program(gl);
  upload(gl, whole, mesh);
  const place = (name) => gl.getUniformLocation(whole, name);
  return () => {
    const { canvas } = gl;
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    canvas.width = Math.max(1, canvas.clientWidth * scale);
    canvas.height = Math.max(1, canvas.clientHeight * scale);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...getComputedStyle(canvas).backgroundColor.match(/[\d.]+/g).slice(0, 3).map((v) => v / 255), 1);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const least = Math.min(canvas.width, canvas.height);
    gl.uniformMatrix3fv(place("turn"), false, turned(pose.yaw, pose.pitch));
    gl.uniform3fv(place("middle"), mesh.middle);
    gl.uniform1f(place("radius"), mesh.radius);
    gl.uniform1f(place("near"), mesh.radius * pose.away);
    gl.uniform2f(place("lens"), (OPENING * least) / canvas.width, (OPENING * least) / canvas.height);
    gl.uniform1i(place("mode"), pose.mode);
    gl.drawElements(gl.TRIANGLES, mesh.corners.length, gl.UNSIGNED_INT, 0);
    canvas.dataset.drawn = Number(canvas.dataset.drawn || 0) + 1;
  };
}

function move(pose, by) {
  pose.yaw = Math.max(-3.2, Math.min(3.2, pose.yaw + (by.yaw || 0)));
  pose.pitch = Math.max(-1.5, Math.min(1.5, pose.pitch + (by.pitch || 0)));
  pose.away = Math.max(0.3, Math.min(12, pose.away * (by.away || 1)));
}

const KEYS = {
  ArrowLeft: { yaw: 0.1 }, ArrowRight: { yaw: -0.1 }, ArrowUp: { pitch: -0.1 }, ArrowDown: { pitch: 0.1 },
  "+": { away: 0.9 }, "=": { away: 0.9 }, "-": { away: 1 / 0.9 },
};

function listen(canvas, pose, paint) {
  const change = (by) => { move(pose, by); paint(); };
  const reset = () => { Object.assign(pose, START); paint(); };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "0" || event.key === "Home") reset();
    else if (KEYS[event.key]) change(KEYS[event.key]);
    else return;
    event.preventDefault();
  });
  canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); canvas.focus({ preventScroll: true }); });
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons) change({ yaw: -event.movementX * 0.008, pitch: event.movementY * 0.008 });
  });
  // The wheel zooms only what was clicked or tabbed to: a page that is read through does not stop here.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    change({ away: Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.003) });
  }, { passive: false });
  return { change, reset };
}

function button(text, says, act) {
  const made_ = made("button", { type: "button", "aria-label": says, title: says }, text);
  made_.addEventListener("click", act);
  return made_;
}

function looks(pose, paint, modes) {
  const choices = modes.map(([mode, says]) => {
    const choice = made("input", { type: "radio", name: "look", value: mode });
    choice.checked = mode === pose.mode;
    choice.addEventListener("change", () => { pose.mode = mode; paint(); });
    return made("label", {}, choice, ` ${says}`);
  });
  return made("fieldset", {}, made("legend", {}, "Colour of the surface"), ...choices);
}

async function show(box) {
  const grid = JSON.parse(box.dataset.grid);
  const values = heights(grid, box.dataset.heights);
  const { places, spots } = points(grid, values);
  const corners = triangles(grid, values);
  if (!corners.length) throw new Error("no two neighbours are known");
  const mesh = { places, spots, corners, normals: normalsOf(places, corners), ...bounds(places, corners) };
  const help = "Drag or use the arrow keys to turn it, plus and minus or the wheel to come nearer, 0 to begin again.";
  const canvas = made("canvas", { tabindex: 0, role: "application", "aria-label": `${box.dataset.says}. ${help}` });
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) throw new Error("no WebGL");
  const textured = Boolean(box.dataset.view && view);
  const pose = { ...START, mode: textured ? 0 : 1 };
  const paint = painter(gl, mesh, pose);
  if (textured) { await view.decode(); photograph(gl); }
  const { change, reset } = listen(canvas, pose, paint);
  const modes = [[0, "photograph"], [1, "shaded"], [2, "normals"]].filter(([mode]) => mode || textured);
  const tools = made("div", { class: "tools" }, looks(pose, paint, modes),
    button("+", "nearer", () => change({ away: 0.8 })), button("−", "farther", () => change({ away: 1.25 })),
    button("reset", "as at the beginning", reset));
  const note = made("p", { class: "note" }, `${help} ${box.dataset.note}`);
  box.replaceChildren(canvas, tools, note);
  paint();
  canvas.addEventListener("webglcontextlost", () => box.prepend(made("p", {}, "The browser has dropped the drawing: reload the page to see it again.")));
  new ResizeObserver(paint).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
}

for (const box of document.querySelectorAll(".surface"))
  show(box).catch((error) => {
    box.querySelector(".instead")?.append(` Here it could not: ${error.message}.`);
  });
