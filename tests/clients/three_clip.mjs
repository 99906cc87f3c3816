// node three_clip.mjs NODE_MODULES FILE.glb SKIN.pc2 MUSCLES.pc2 FPS [PICTURES_FOLDER]
// Plays an animated character in three.js in a real browser (headless Chromium). Exit code 1 where its skin or its muscles are elsewhere than in the exact
// vertex caches of the same motion by more than the file states, or where muscles have come out of the skin that three.js shows and not of the exact one.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { browse, document } from './browser.mjs';

const [, , modules, file, skinFile, muscleFile, fpsText, pictures] = process.argv;
const fps = Number(fpsText), kSamples = 3000, kMoreOutside = 0.001;

function readCache(path) {
  const bytes = readFileSync(path);
  const vertices = bytes.readInt32LE(16), frames = bytes.readInt32LE(28);
  return { vertices, frames, of: (frame) => new Float32Array(bytes.buffer.slice(bytes.byteOffset + 32 + 12 * vertices * frame, bytes.byteOffset + 32 + 12 * vertices * (frame + 1))) };
}

const gltf = document(file), stated = gltf.scenes[0].extras.ecorche.shapes;
const caches = { skin: readCache(skinFile), muscles: readCache(muscleFile) };
const frames = [...new Set([0, 0.3, 0.6, 0.9].map((share) => Math.round(share * (caches.skin.frames - 1))))];
const got = { skin: new Map(), muscles: new Map() };

// Numbers of an accessor of the file's skin.
function numbers(of, kind) {
  const bytes = readFileSync(file), binary = 20 + bytes.readUInt32LE(12) + 8;
  const primitive = gltf.meshes[gltf.nodes.find((node) => node.name === 'skin').mesh].primitives[0];
  const accessor = gltf.accessors[of === 'indices' ? primitive.indices : primitive.attributes[of]];
  const at = bytes.byteOffset + binary + (gltf.bufferViews[accessor.bufferView].byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  return new kind(bytes.buffer.slice(at, at + 4 * accessor.count));
}

// Whether a point lies in a closed surface: the solid angle that it is seen under (van Oosterom and Strackee 1983, 10.1109/TBME.1983.325207).
function inside(px, py, pz, V, F) {
  let sum = 0;
  for (let f = 0; f < F.length; f += 3) {
    const a = 3 * F[f], b = 3 * F[f + 1], c = 3 * F[f + 2];
    const ax = V[a] - px, ay = V[a + 1] - py, az = V[a + 2] - pz, bx = V[b] - px, by = V[b + 1] - py, bz = V[b + 2] - pz;
    const cx = V[c] - px, cy = V[c + 1] - py, cz = V[c + 2] - pz;
    const la = Math.sqrt(ax * ax + ay * ay + az * az), lb = Math.sqrt(bx * bx + by * by + bz * bz), lc = Math.sqrt(cx * cx + cy * cy + cz * cz);
    const volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
    const rest = la * lb * lc + (ax * bx + ay * by + az * bz) * lc + (bx * cx + by * cy + bz * cz) * la + (cx * ax + cy * ay + cz * az) * lb;
    sum += Math.atan2(volume, rest);
  }
  return sum > Math.PI;  // half of the solid angle, over half of the sphere
}

function compare(what) {
  const cache = caches[what];
  let square = 0, most = 0, count = 0;
  for (const frame of frames) {
    const there = got[what].get(String(frame / fps)), exact = cache.of(frame);
    if (!there || there.length < exact.length || (what === 'muscles' && there.length !== exact.length))
      throw new Error(`${what}, frame ${frame}: ${there?.length} numbers came back for ${exact.length}`);
    for (let k = 0; k < exact.length; k += 3) {  // copies on the texture's seams come after the skin's own
      const off = (there[k] - exact[k]) ** 2 + (there[k + 1] - exact[k + 1]) ** 2 + (there[k + 2] - exact[k + 2]) ** 2;
      square += off;
      most = Math.max(most, off);
      ++count;
    }
  }
  return { rms: Math.sqrt(square / count), most: Math.sqrt(most) };
}

// Shares of the muscles' points that lie in the skin at rest (some are about the mouth, whose inside is none of the body's) and have left it: as
// three.js has them, and exactly.
function outside() {
  const F = numbers('indices', Uint32Array), own = numbers('_SKIN_VERTEX', Float32Array), step = 3 * Math.max(1, Math.floor(caches.muscles.vertices / kSamples));
  const out = (P, k, V) => !inside(P[k], P[k + 1], P[k + 2], V, F);
  const rest = { V: got.skin.get('rest'), P: got.muscles.get('rest') };
  const kept = [];
  for (let k = 0; k + 2 < rest.P.length; k += step) if (!out(rest.P, k, rest.V)) kept.push(k);
  let there = 0, exactly = 0;
  for (const frame of frames) {
    const P = got.muscles.get(String(frame / fps)), V = got.skin.get(String(frame / fps)), p = caches.muscles.of(frame), base = caches.skin.of(frame);
    const v = new Float32Array(3 * own.length).map((_, i) => base[3 * own[Math.floor(i / 3)] + i % 3]);
    for (const k of kept) {
      there += out(P, k, V);
      exactly += out(p, k, v);
    }
  }
  const count = kept.length * frames.length;
  return { share: there / count, exact: exactly / count, count };
}

function judge(answer) {
  for (const each of answer.pictures) writeFileSync(join(pictures, `three-${each.name}.png`), Buffer.from(each.picture.split(',')[1], 'base64'));
  const kRounding = 1e-4;  // m; weights of 16 bits, keys and places of 32
  for (const what of ['skin', 'muscles']) {
    const { rms, most } = compare(what);
    console.log(`${file}: three.js r${answer.version}: ${what} ${(1e3 * rms).toFixed(2)} mm RMS and at most ${(1e3 * most).toFixed(2)} mm off in frames ${frames.join(', ')}`);
    if (most > stated[what].max + kRounding) throw new Error(`the file states at most ${1e3 * stated[what].max} mm`);
  }
  const { share, exact, count } = outside();
  console.log(`${file}: three.js r${answer.version}: ${answer.meshes} muscle meshes, ${(100 * share).toFixed(3)} % of ${count} muscle points outside the skin (exactly ${(100 * exact).toFixed(3)} %); ${answer.mixing.toFixed(1)} ms a frame to mix`);
  if (share > exact + kMoreOutside) throw new Error('muscles come out of the skin');
}

browse({
  what: file, modules, page: 'three_clip.html', judge,
  serve: (path) => path === '/asked.json' ? JSON.stringify({ times: frames.map((frame) => frame / fps), pictures: Boolean(pictures) })
    : path === '/file.glb' ? readFileSync(file) : undefined,
  take: (url, floats) => got[url.searchParams.get('what')].set(url.searchParams.get('at'), floats),
});
