// node three_crowd.mjs NODE_MODULES CROWD SKINS_FOLDER [--motion NAME] [--pictures FOLDER]
// Opens a crowd (.glb, or .gltf with its people beside it) in three.js in headless Chromium and compares each person's skin with the same
// person's own file of a `body population --skins`, SKINS_FOLDER/NAME.glb, put where the crowd says the person stands. Exit code 1 when a
// vertex or a normal is elsewhere, people reach into each other, a mesh is missing, or a skin is not drawn where it is. With a motion, one of people
// who keep to the ground: when it does not move each of them, or not on the ground.
import { readFileSync, writeFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { browse, document } from './browser.mjs';

const [, , modules, file, skins, ...more] = process.argv;
const option = (name) => more.includes(name) ? more[more.indexOf(name) + 1] : undefined;
const motion = option('--motion'), pictures = option('--pictures'), shares = [0.25, 0.5, 0.75];
const crowd = document(file), got = new Map();
const kMost = 5e-5, kTurn = 1.5;  // m; degrees, of an 8-bit normal

function ownSkin(name) {
  const path = join(skins, `${name}.glb`), bytes = readFileSync(path), own = document(path);
  const { attributes } = own.meshes[own.nodes.find((node) => node.name === 'skin').mesh].primitives[0];
  const values = (index) => {
    const { bufferView, count } = own.accessors[index], start = 28 + bytes.readUInt32LE(12) + (own.bufferViews[bufferView].byteOffset ?? 0);
    return new Float32Array(bytes.buffer.slice(bytes.byteOffset + start, bytes.byteOffset + start + 12 * count));
  };
  return { positions: values(attributes.POSITION), normals: values(attributes.NORMAL) };
}

function compare(name, found) {
  const own = ownSkin(name), place = crowd.nodes.find((node) => node.name === name).translation;
  if (found.length !== 2 * own.positions.length) throw new Error(`${name}: ${found.length / 6} vertices, ${own.positions.length / 3} in their own file`);
  let most = 0, turned = 0;
  const box = { low: [1e9, 1e9, 1e9], high: [-1e9, -1e9, -1e9] };
  for (let v = 0; v < own.positions.length / 3; ++v) {
    let square = 0, cosine = 0;
    for (let k = 0; k < 3; ++k) {
      const x = found[6 * v + k];
      square += (x - place[k] - own.positions[3 * v + k]) ** 2;
      cosine += found[6 * v + 3 + k] * own.normals[3 * v + k];
      box.low[k] = Math.min(box.low[k], x), box.high[k] = Math.max(box.high[k], x);
    }
    most = Math.max(most, Math.sqrt(square));
    turned = Math.max(turned, Math.acos(Math.min(1, cosine)) * 180 / Math.PI);
  }
  if (!(most <= kMost)) throw new Error(`${name}: a vertex is ${1e3 * most} mm from where their own file has it`);
  if (!(turned <= kTurn)) throw new Error(`${name}: a normal is ${turned} degrees off`);
  return { most, turned, box };
}

// How far the lowest point of somebody who moves is from the ground at most, and how far the first vertex goes at least.
function compareMoving(name) {
  const rest = got.get(name);
  let off = 0, gone = Infinity;
  for (const share of shares) {
    const found = got.get(`${name} ${share}`) ?? [];
    let low = Infinity;
    for (let i = 1; i < found.length; i += 6) low = Math.min(low, found[i]);
    off = Math.max(off, Math.abs(low));
    gone = Math.min(gone, Math.hypot(found[0] - rest[0], found[1] - rest[1], found[2] - rest[2]));
  }
  if (!(off < 0.02)) throw new Error(`${name}: ${1e3 * off} mm off the ground`);
  if (!(gone > 0.1)) throw new Error(`${name}: does not move along`);
  return off;
}

function judge(answer) {
  for (const { what, picture } of answer.pictures) if (pictures) writeFileSync(join(pictures, `crowd-${what}.png`), Buffer.from(picture.split(',')[1], 'base64'));
  const names = crowd.nodes.filter((node) => node.name.endsWith('/skin')).map((node) => node.name.slice(0, -5));
  if (names.length === 0 || names.length !== crowd.scenes[0].extras.crowd.people || answer.meshes !== crowd.meshes.length)
    throw new Error(`${names.length} people, ${answer.meshes} meshes of ${crowd.meshes.length}`);
  const people = names.map((name) => compare(name, got.get(name) ?? []));
  for (const one of people) for (const other of people)
    if (one !== other && [0, 1, 2].every((k) => one.box.low[k] < other.box.high[k] && other.box.low[k] < one.box.high[k]))
      throw new Error('two people reach into each other');
  for (const { hit, seen } of answer.shown) if (hit < 0.99 || seen < 0.99) throw new Error(`a skin is not drawn where it is: ${hit} of ${seen}`);
  const ground = motion ? `, at most ${(1e3 * Math.max(...names.map(compareMoving))).toFixed(1)} mm off the ground in ${motion}` : '';
  console.log(`${file}: three.js r${answer.version} shows ${names.length} people in ${answer.meshes} meshes, at most `
    + `${(1e3 * Math.max(...people.map((one) => one.most))).toFixed(3)} mm and ${Math.max(...people.map((one) => one.turned)).toFixed(2)} degrees from their own files${ground}`);
}

browse({
  what: file, modules, page: 'three_crowd.html', judge,
  serve: (path) => path === '/asked.json' ? JSON.stringify({ file: basename(file), motion, shares })
    : path.startsWith('/crowd/') ? readFileSync(join(dirname(file), basename(path))) : undefined,
  take: (url, floats) => got.set([url.searchParams.get('name'), url.searchParams.get('share')].filter((part) => part).join(' '), floats),
});
