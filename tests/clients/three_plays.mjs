// node three_plays.mjs NODE_MODULES FILE.glb MOTION CACHE.pc2 FPS [PICTURES_FOLDER]
// Plays a motion of a character in three.js in a real browser (headless Chromium) and compares the skin with the exact vertex cache of
// the same motion: exit code 1 when three.js has it elsewhere than the file states (scenes[0].extras.bake), or does not draw it there.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { browse, document } from './browser.mjs';

const [, , modules, file, motion, cacheFile, fpsText, pictures] = process.argv;
const fps = Number(fpsText);

function readCache(path) {
  const bytes = readFileSync(path);
  const vertices = bytes.readInt32LE(16), frames = bytes.readInt32LE(28);
  return { vertices, frames, at: (frame, i) => bytes.readFloatLE(32 + 4 * (3 * vertices * frame + i)) };
}

const cache = readCache(cacheFile), stated = document(file).scenes[0].extras.bake.error;
const frames = [...new Set([0, 0.25, 0.5, 0.75].map((share) => Math.round(share * (cache.frames - 1))))];
const got = new Map();

function compare() {
  let sum = 0, most = 0, count = 0;
  for (const frame of frames) {
    const there = got.get(frame);
    if (!there || there.length !== 3 * cache.vertices) throw new Error(`frame ${frame}: no places came back`);
    for (let v = 0; v < cache.vertices; ++v) {
      let square = 0;
      for (let k = 3 * v; k < 3 * v + 3; ++k) square += (there[k] - cache.at(frame, k)) ** 2;
      sum += square;
      most = Math.max(most, Math.sqrt(square));
      ++count;
    }
  }
  return { rms: Math.sqrt(sum / count), most };
}

function judge(answer) {
  const { rms, most } = compare();
  console.log(`${file}: three.js r${answer.version} plays ${motion} (${answer.duration.toFixed(2)} s, ${answer.morphs} morph targets), `
    + `${(1e3 * rms).toFixed(2)} mm RMS and at most ${(1e3 * most).toFixed(2)} mm from the exact skin`);
  for (const each of answer.pictures) if (pictures) writeFileSync(join(pictures, `three-${each.time.toFixed(2)}.png`), Buffer.from(each.picture.split(',')[1], 'base64'));
  // Four frames of many may be worse than the mean, but no vertex than the worst. Key times and places are floats.
  if (most > stated.max + 1e-4) throw new Error(`the file states at most ${1e3 * stated.max} mm`);
  for (const each of answer.pictures)
    if (each.hit < 0.99 || each.seen < 0.99 || each.lit < 0.03) throw new Error(`at ${each.time} s the skin is not drawn where it is: ${JSON.stringify({ ...each, picture: 0 })}`);
}

browse({
  what: file, modules, page: 'three_plays.html', judge,
  serve: (path) => path === '/asked.json' ? JSON.stringify({ vertices: cache.vertices, motion, times: frames.map((frame) => frame / fps) })
    : path === '/file.glb' ? readFileSync(file) : undefined,
  take: (url, floats) => got.set(Math.round(Number(url.searchParams.get('time')) * fps), floats),
});
