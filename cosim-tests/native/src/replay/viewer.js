"use strict";
// Draws the landing on a plain canvas: ground first, then faces from far to near.

const film = JSON.parse(document.getElementById("data").textContent);
const { frames, shape, ground } = film;
const element = (id) => document.getElementById(id);
const canvas = element("view");
const pen = canvas.getContext("2d");
const END_S = frames[frames.length - 1].time_s;
const SUN = unit([0.45, -0.6, 0.66]);
const LANDED = film.outcome === "landed";

// ---- vectors
function add(a, b, s = 1) { return [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]; }
function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
function unit(a) { const n = Math.hypot(...a) || 1; return a.map((x) => x / n); }
function mix(a, b, s) { return a.map((x, i) => x + (b[i] - x) * s); }
function turn([x, y, z, w], v) {
  const t = cross([x, y, z], v).map((c) => 2 * c);
  return add(add(v, t, w), cross([x, y, z], t));
}

// ---- the state at a time, between two frames
function at(time) {
  let low = 0, high = frames.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (frames[middle].time_s <= time) low = middle; else high = middle;
  }
  const a = frames[low], b = frames[high];
  const span = b.time_s - a.time_s;
  const s = span > 0 ? Math.min(1, Math.max(0, (time - a.time_s) / span)) : 0;
  const sign = a.attitude.reduce((sum, q, i) => sum + q * b.attitude[i], 0) < 0 ? -1 : 1;
  const between = (name) => a[name] + (b[name] - a[name]) * s;
  const all = (name) => mix(a[name], b[name], s);
  const attitude = unit(mix(a.attitude, b.attitude.map((q) => sign * q), s));
  return {
    time, attitude, position: all("position_w"), velocity: all("velocity_w"), gimbal: all("gimbal_rad"),
    strokes: all("strokes_m"), loads: all("loads_n"), thrust: between("thrust_n"),
    propellant: between("propellant_kg"), tilt: between("tilt_deg"),
  };
}

// ---- ground
function corners(patch) {
  const n = patch.squares + 1;
  return (row, column) => [
    patch.least_x_m + column * patch.spacing_m,
    patch.least_y_m + row * patch.spacing_m,
    patch.heights_m[row * n + column],
  ];
}
function heightAt(x, y) {
  const patch = ground.site, n = patch.squares;
  const u = Math.min(n - 1e-9, Math.max(0, (x - patch.least_x_m) / patch.spacing_m));
  const v = Math.min(n - 1e-9, Math.max(0, (y - patch.least_y_m) / patch.spacing_m));
  const corner = corners(patch), row = Math.floor(v), column = Math.floor(u);
  const low = corner(row, column)[2] * (1 - u + column) + corner(row, column + 1)[2] * (u - column);
  const high = corner(row + 1, column)[2] * (1 - u + column) + corner(row + 1, column + 1)[2] * (u - column);
  return low + (high - low) * (v - row);
}
function tiles(patch) {
  const corner = corners(patch), all = [];
  for (let row = 0; row < patch.squares; row++) {
    for (let column = 0; column < patch.squares; column++) {
      const points = [corner(row, column), corner(row, column + 1), corner(row + 1, column + 1), corner(row + 1, column)];
      const normal = unit(cross(add(points[2], points[0], -1), add(points[3], points[1], -1)));
      const light = 0.25 + 0.75 * Math.max(0, dot(normal, SUN));
      const tone = light * ((row + column) % 2 ? 98 : 92);
      all.push({ points, fill: `rgb(${tone},${tone * 0.98},${tone * 0.95})` });
    }
  }
  return all;
}
// The site lies on its surroundings, which are too coarse to show it.
const land = [tiles(ground.around), tiles(ground.site)];

// ---- the lander's faces in its body frame
function ring(center, radius, n = 16) {
  return Array.from({ length: n }, (_, i) => {
    const angle = (2 * Math.PI * i) / n;
    return [center[0] + radius * Math.cos(angle), center[1] + radius * Math.sin(angle), center[2]];
  });
}
function frustum(bottom, top, color, closed = true) {
  const faces = bottom.map((point, i) => {
    const next = (i + 1) % bottom.length;
    return { points: [point, bottom[next], top[next], top[i]], color };
  });
  if (closed) faces.push({ points: top, color }, { points: [...bottom].reverse(), color });
  return faces;
}
const HULL = frustum(
  ring([0, 0, shape.hull_bottom_m], shape.hull_radius_m, 8), ring([0, 0, shape.hull_top_m], 0.92 * shape.hull_radius_m, 8),
  [214, 190, 120]);
const NOZZLE = (gimbal) => {
  const [pivot, length] = [shape.pivot_b, shape.pivot_b[2] - shape.nozzle_exit_m];
  const tilt = (p) => gimbaled(gimbal, p);
  const exit = ring([0, 0, -length], shape.nozzle_radius_m, 12).map(tilt);
  const throat = ring([0, 0, 0], 0.35 * shape.nozzle_radius_m, 12).map(tilt);
  const place = (p) => add(pivot, p);
  return frustum(exit.map(place), throat.map(place), [92, 92, 104], false);
};
// About body x, then about body y.
function gimbaled([x, y], [px, py, pz]) {
  const [qy, qz] = [py * Math.cos(x) - pz * Math.sin(x), py * Math.sin(x) + pz * Math.cos(x)];
  return [px * Math.cos(y) + qz * Math.sin(y), qy, qz * Math.cos(y) - px * Math.sin(y)];
}
function leg(n, stroke) {
  const foot = add(shape.feet_b[n], shape.stroke_axes_b[n], stroke);
  const out = unit([foot[0], foot[1], 0]), side = [-out[1], out[0], 0];
  const rim = (height, sideways) => add(
    add([0, 0, height], out, 0.95 * shape.hull_radius_m), side, sideways * 0.35 * shape.hull_radius_m);
  const ankle = add(foot, [0, 0, 0.06]);
  const faces = frustum(
    ring(foot, shape.pad_radius_m * 1.6 + 0.1, 10), ring(add(foot, [0, 0, 0.05]), shape.pad_radius_m + 0.05, 10), [150, 152, 160]);
  const high = rim(shape.hull_top_m * 0.85 + shape.hull_bottom_m * 0.15, 0);
  const knee = mix(ankle, high, 0.55);
  const struts = [
    [ankle, knee, 5, [196, 198, 205]], [knee, high, 8, [150, 152, 160]],
    [ankle, rim(shape.hull_bottom_m, 1), 4, [150, 152, 160]], [ankle, rim(shape.hull_bottom_m, -1), 4, [150, 152, 160]],
  ];
  return { faces, struts };
}

// ---- camera
const camera = { azimuth: -2.2, elevation: 0.22, distance: 14, mode: "follow" };
function eyeOf(state) {
  const rest = frames[frames.length - 1].position_w;
  const middle = { follow: add(state.position, [0, 0, 1]), site: add(rest, [0, 0, 1]), whole: mix(rest, frames[0].position_w, 0.5) }[camera.mode];
  const out = [
    Math.cos(camera.elevation) * Math.cos(camera.azimuth), Math.cos(camera.elevation) * Math.sin(camera.azimuth),
    Math.sin(camera.elevation)];
  const eye = add(middle, out, camera.distance);
  // Never underground.
  eye[2] = Math.max(eye[2], heightAt(eye[0], eye[1]) + 0.3);
  const forward = unit(add(middle, eye, -1));
  const right = unit(cross(forward, [0, 0, 1]));
  return { eye, forward, right, up: cross(right, forward), focal: 1.1 * Math.min(canvas.width, canvas.height) };
}
const NEAR_M = 0.2;
function seen(view, point) {
  const d = add(point, view.eye, -1);
  return [dot(d, view.right), dot(d, view.up), dot(d, view.forward)];
}
function onScreen(view, [x, y, z]) {
  return [canvas.width / 2 + (view.focal * x) / z, canvas.height / 2 - (view.focal * y) / z];
}
// What lies before the near plane.
function clipped(points) {
  const kept = [];
  points.forEach((p, i) => {
    const q = points[(i + 1) % points.length];
    if (p[2] >= NEAR_M) kept.push(p);
    if ((p[2] >= NEAR_M) !== (q[2] >= NEAR_M)) kept.push(mix(p, q, (NEAR_M - p[2]) / (q[2] - p[2])));
  });
  return kept;
}
function polygon(view, points, fill) {
  const kept = clipped(points.map((p) => seen(view, p)));
  if (kept.length < 3) return;
  pen.beginPath();
  kept.forEach((p, i) => { const [x, y] = onScreen(view, p); if (i) pen.lineTo(x, y); else pen.moveTo(x, y); });
  pen.closePath();
  pen.fillStyle = fill;
  pen.fill();
  // Hides the seams between neighbours.
  pen.strokeStyle = fill;
  pen.lineWidth = 1;
  pen.stroke();
}
function line(view, a, b, width, color) {
  const [p, q] = [seen(view, a), seen(view, b)];
  if (p[2] < NEAR_M && q[2] < NEAR_M) return;
  const cut = (inside, outside) => mix(inside, outside, (NEAR_M - inside[2]) / (outside[2] - inside[2]));
  const from = p[2] < NEAR_M ? cut(q, p) : p, to = q[2] < NEAR_M ? cut(p, q) : q;
  pen.beginPath();
  pen.moveTo(...onScreen(view, from));
  pen.lineTo(...onScreen(view, to));
  pen.strokeStyle = color;
  pen.lineWidth = Math.max(1, width);
  pen.lineCap = "round";
  pen.stroke();
}

// ---- drawing
function shade(color, normal) {
  const light = 0.38 + 0.62 * Math.max(0, dot(normal, SUN));
  return `rgb(${color.map((c) => Math.round(c * light)).join(",")})`;
}
function drawGround(view) {
  const depth = (tile) => dot(add(tile.points[0], view.eye, -1), view.forward);
  for (const patch of land) {
    patch.sort((a, b) => depth(b) - depth(a)).forEach((tile) => polygon(view, tile.points, tile.fill));
  }
  for (const [x, y, z, r] of ground.rocks) {
    const [px, py, pz] = seen(view, [x, y, z]);
    if (pz < NEAR_M) continue;
    pen.beginPath();
    pen.arc(...onScreen(view, [px, py, pz]), (view.focal * r) / pz, 0, 2 * Math.PI);
    pen.fillStyle = "#5d5b58";
    pen.fill();
  }
  const target = ring([film.target_w[0], film.target_w[1], 0], 3, 48).map(([x, y]) => [x, y, heightAt(x, y) + 0.02]);
  target.forEach((p, i) => line(view, p, target[(i + 1) % target.length], 2, "#f2603c"));
}
function drawPath(view, time) {
  for (let i = 1; i < frames.length; i++) {
    const [a, b] = [frames[i - 1], frames[i]];
    const color = b.time_s > time ? "#56637a" : b.thrust_n > 1 ? "#f5a742" : "#7fb2ff";
    line(view, a.position_w, b.position_w, 1.5, color);
  }
}
function drawShadow(view, place) {
  const drop = (p) => {
    const w = place(p), t = (w[2] - heightAt(w[0], w[1])) / SUN[2];
    const [x, y] = [w[0] - SUN[0] * t, w[1] - SUN[1] * t];
    return [x, y, heightAt(x, y) + 0.01];
  };
  polygon(view, ring([0, 0, shape.hull_bottom_m], shape.hull_radius_m, 8).map(drop), "rgba(0,0,0,0.45)");
  shape.feet_b.forEach((foot) => line(view, drop(foot), drop([0, 0, shape.hull_bottom_m]), 4, "rgba(0,0,0,0.45)"));
}
function drawPlume(view, state, place) {
  const share = state.thrust / shape.thrust_max_n;
  if (share < 0.01) return;
  const length = shape.pivot_b[2] - shape.nozzle_exit_m;
  for (const [reach, alpha] of [[6, 0.18], [4, 0.3], [2, 0.55]]) {
    const ends = [ring([0, 0, -length], shape.nozzle_radius_m, 10), ring([0, 0, -length - reach * share], 2.2 * shape.nozzle_radius_m, 10)];
    const [top, bottom] = ends.map((circle) => circle.map((p) => place(add(shape.pivot_b, gimbaled(state.gimbal, p)))));
    const outline = [top[0], top[5], bottom[5], bottom[0]];
    const other = [top[2], top[7], bottom[7], bottom[2]];
    [outline, other].forEach((points) => polygon(view, points, `rgba(255,190,90,${alpha})`));
  }
}
function drawLander(view, state) {
  const place = (p) => add(state.position, turn(state.attitude, p));
  drawShadow(view, place);
  drawPlume(view, state, place);
  const legs = shape.feet_b.map((_, n) => leg(n, state.strokes[n] || 0));
  const things = [];
  for (const face of [...HULL, ...NOZZLE(state.gimbal), ...legs.flatMap((one) => one.faces)]) {
    const points = face.points.map(place);
    const middle = points.reduce((sum, p) => add(sum, p), [0, 0, 0]).map((c) => c / points.length);
    const normal = unit(cross(add(points[1], points[0], -1), add(points[2], points[0], -1)));
    const depth = dot(add(middle, view.eye, -1), view.forward);
    things.push({ depth, draw: () => polygon(view, points, shade(face.color, normal)) });
  }
  legs.forEach((one, n) => one.struts.forEach(([a, b, width, color]) => {
    const [from, to] = [place(a), place(b)];
    const depth = dot(add(mix(from, to, 0.5), view.eye, -1), view.forward);
    const loaded = state.loads[n] > 50 ? [255, 170, 80] : color;
    const pixels = (width * view.focal) / Math.max(1, depth) / 100;
    things.push({ depth, draw: () => line(view, from, to, pixels, `rgb(${loaded.join(",")})`) });
  }));
  things.sort((a, b) => b.depth - a.depth).forEach((thing) => thing.draw());
}
function drawSky() {
  pen.fillStyle = "#05070b";
  pen.fillRect(0, 0, canvas.width, canvas.height);
}

// ---- panels
function row(label, value) { return `<tr><td>${label}</td><td>${value}</td></tr>`; }
function bar(share) { return `<span class="bar"><i style="width:${100 * Math.min(1, Math.max(0, share))}%"></i></span>`; }
function panel(state) {
  const [x, y, z] = state.position;
  const [vx, vy, vz] = state.velocity;
  const fixed = (value, digits) => (Object.is(value, -0) ? 0 : value).toFixed(digits);
  const legs = shape.feet_b.map((_, n) => row(`leg ${n + 1} stroke`,
    `${bar((state.strokes[n] || 0) / shape.stroke_max_m)} ${fixed(100 * (state.strokes[n] || 0), 1)} cm`));
  element("state").innerHTML = `<table>${[
    row("height", `${fixed(z - heightAt(x, y), 2)} m`),
    row("to the target", `${fixed(Math.hypot(x - film.target_w[0], y - film.target_w[1]), 2)} m`),
    row("down", `${fixed(-vz, 2)} m/s`), row("across", `${fixed(Math.hypot(vx, vy), 2)} m/s`),
    row("tilt", `${fixed(state.tilt, 1)}°`), row("thrust", `${fixed(state.thrust, 0)} N`),
    row("propellant", `${fixed(state.propellant, 2)} kg`), ...legs].join("")}</table>`;
  element("clock").textContent = `${fixed(state.time, 2)} / ${fixed(END_S, 2)} s`;
}

// ---- time
const clock = { time: 0, playing: false, last: null };
function draw() {
  const state = at(clock.time), view = eyeOf(state);
  drawSky();
  drawGround(view);
  drawPath(view, clock.time);
  drawLander(view, state);
  panel(state);
  element("scrub").value = String((1000 * clock.time) / END_S);
}
function step(now) {
  if (clock.playing) {
    if (clock.last !== null) clock.time += ((now - clock.last) / 1000) * Number(element("speed").value);
    clock.last = now;
    if (clock.time >= END_S) { clock.time = END_S; play(false); }
    draw();
    requestAnimationFrame(step);
  }
}
function play(on) {
  if (on && clock.time >= END_S) clock.time = 0;
  clock.playing = on;
  clock.last = null;
  element("play").textContent = on ? "Pause" : "Play";
  if (on) requestAnimationFrame(step);
}
function seek(time) {
  clock.time = Math.min(END_S, Math.max(0, time));
  draw();
}
function look(mode) {
  camera.mode = mode;
  const start = frames[0].position_w, rest = frames[frames.length - 1].position_w;
  camera.distance = mode === "whole" ? 1.3 * Math.hypot(...add(start, rest, -1)) + 10 : 14;
  draw();
}

// ---- controls
element("play").onclick = () => play(!clock.playing);
element("scrub").oninput = (event) => { play(false); seek((END_S * Number(event.target.value)) / 1000); };
element("camera").onchange = (event) => look(event.target.value);
addEventListener("keydown", (event) => {
  if (event.target.tagName === "SELECT") return;
  const moves = { ArrowLeft: -0.05, ArrowRight: 0.05, Home: -END_S, End: END_S };
  if (event.code === "Space") play(!clock.playing);
  else if (event.key in moves) { play(false); seek(clock.time + moves[event.key]); }
  else return;
  event.preventDefault();
});
canvas.addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  camera.azimuth -= event.movementX * 0.008;
  camera.elevation = Math.min(1.5, Math.max(-0.1, camera.elevation + event.movementY * 0.006));
  draw();
});
canvas.addEventListener("wheel", (event) => {
  camera.distance = Math.min(5000, Math.max(3, camera.distance * Math.exp(event.deltaY * 0.001)));
  draw();
  event.preventDefault();
}, { passive: false });
function fit() {
  const ratio = devicePixelRatio || 1;
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  draw();
}
addEventListener("resize", fit);

// ---- start: `#t=12.5&camera=site` opens there
const verdict = element("verdict");
verdict.classList.add(LANDED ? "landed" : "bad");
const [headline, ...rest] = verdict.querySelector("pre").textContent.split("\n");
verdict.querySelector("summary").textContent = headline;
verdict.querySelector("pre").textContent = rest.join("\n");
const mark = (time, label) => time === null ? "" :
  `<span style="left:${(100 * time) / END_S}%">${label}</span>`;
element("marks").innerHTML = mark(film.contact_time_s, "contact") + mark(film.tip_time_s, "tips over");
const asked = new URLSearchParams(location.hash.slice(1));
const modes = [...element("camera").options].map((option) => option.value);
camera.mode = modes.includes(asked.get("camera")) ? asked.get("camera") : modes[0];
element("camera").value = camera.mode;
clock.time = Math.min(END_S, Number(asked.get("t") || 0));
look(camera.mode);
fit();
document.body.dataset.ready = "yes";
