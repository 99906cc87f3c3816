// node three_plays.mjs NODE_MODULES FILE.glb MOTION CACHE.pc2 FPS [PICTURES_FOLDER]
// Plays a motion of a character in three.js in a real browser (headless Chromium) and compares the skin with the exact vertex cache of
// the same motion: exit code 1 when three.js has it elsewhere than the file states (scenes[0].extras.bake), or does not draw it there.
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

const [, , modules, file, motion, cacheFile, fpsText, pictures] = process.argv;
const here = dirname(fileURLToPath(import.meta.url)), fps = Number(fpsText);
const seconds = 240;  // a software renderer on a busy machine

function readCache(path) {
  const bytes = readFileSync(path);
  const vertices = bytes.readInt32LE(16), frames = bytes.readInt32LE(28);
  return { vertices, frames, at: (frame, i) => bytes.readFloatLE(32 + 4 * (3 * vertices * frame + i)) };
}

function statedError(path) {
  const bytes = readFileSync(path);
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12))).scenes[0].extras.bake.error;
}

const cache = readCache(cacheFile), stated = statedError(file);
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
  if (answer.error) throw new Error(answer.error);
  const { rms, most } = compare();
  console.log(`${file}: three.js r${answer.version} plays ${motion} (${answer.duration.toFixed(2)} s, ${answer.morphs} morph targets), `
    + `${(1e3 * rms).toFixed(2)} mm RMS and at most ${(1e3 * most).toFixed(2)} mm from the exact skin`);
  for (const each of answer.pictures) if (pictures) writeFileSync(join(pictures, `three-${each.time.toFixed(2)}.png`), Buffer.from(each.picture.split(',')[1], 'base64'));
  // Four frames of many may be worse than the mean, but no vertex than the worst. Key times and places are floats.
  if (most > stated.max + 1e-4) throw new Error(`the file states at most ${1e3 * stated.max} mm`);
  for (const each of answer.pictures)
    if (each.hit < 0.99 || each.seen < 0.99 || each.lit < 0.03) throw new Error(`at ${each.time} s the skin is not drawn where it is: ${JSON.stringify({ ...each, picture: 0 })}`);
}

const kinds = { '.js': 'text/javascript', '.html': 'text/html' };
const scratch = mkdtempSync(join(tmpdir(), 'ecorche-three-'));
let browser;
function end(code) {
  browser?.kill('SIGKILL');
  browser?.on('exit', () => rmSync(scratch, { recursive: true, force: true, maxRetries: 5, retryDelay: 200 }));
  server.close();
  setTimeout(() => process.exit(code), 1000);
}

const server = createServer((request, response) => {
  const url = new URL(request.url, 'http://localhost');
  const send = (body, kind) => response.writeHead(200, { 'Content-Type': kind }).end(body);
  if (request.method === 'POST') {
    const parts = [];
    request.on('data', (part) => parts.push(part)).on('end', () => {
      const body = Buffer.concat(parts);
      response.end();
      if (url.pathname === '/places') {
        got.set(Math.round(Number(url.searchParams.get('time')) * fps), new Float32Array(body.buffer.slice(body.byteOffset, body.byteOffset + body.length)));
      } else {
        try {
          judge(JSON.parse(body));
          end(0);
        } catch (error) {
          console.log(`${file}: ${error.message}`);
          end(1);
        }
      }
    });
  } else if (url.pathname === '/') send(readFileSync(join(here, 'three_plays.html')), kinds['.html']);
  else if (url.pathname === '/asked') send(JSON.stringify({ vertices: cache.vertices, motion, times: frames.map((frame) => frame / fps) }), 'application/json');
  else if (url.pathname === '/file.glb') send(readFileSync(file), 'model/gltf-binary');
  else if (url.pathname.startsWith('/three/')) {
    try {
      send(readFileSync(join(modules, normalize(url.pathname))), kinds[extname(url.pathname)] ?? 'text/plain');
    } catch {
      response.writeHead(404).end();
    }
  } else response.writeHead(404).end();
});

server.listen(0, '127.0.0.1', () => {
  browser = spawn('chromium', ['--headless=new', '--no-sandbox', '--disable-gpu-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--disable-background-networking', `--user-data-dir=${scratch}`, `http://127.0.0.1:${server.address().port}/`], { stdio: 'ignore' });
  browser.on('error', (error) => { console.log(`chromium: ${error.message}`); end(1); });
});
setTimeout(() => { console.log(`${file}: nothing came back within ${seconds} s`); end(1); }, 1000 * seconds).unref();
