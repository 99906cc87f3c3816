// A page of three.js in headless Chromium: serves it what it asks for, takes what it finds, ends the process with 0 or 1.
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const kinds = { '.js': 'text/javascript', '.html': 'text/html', '.json': 'application/json', '.glb': 'model/gltf-binary', '.gltf': 'model/gltf+json' };
const seconds = 240;  // a software renderer on a busy machine

// The JSON of a .glb or a .gltf.
export function document(path) {
  const bytes = readFileSync(path);
  return JSON.parse(extname(path) === '.gltf' ? bytes : bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
}

// what: the file that messages name. page: beside this script. serve(path): bytes or text for a path, or undefined. take(url, floats): what
// the page posts. judge(answer): what it posts to /done at last; throws where that is not as it should be.
export function browse({ what, modules, page, serve, take, judge }) {
  const scratch = mkdtempSync(join(tmpdir(), 'ecorche-three-'));
  let browser;
  const clean = () => {
    try {
      rmSync(scratch, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
    } catch {
      console.error(`${scratch}: left behind`);  // the browser's last helper still writes there; no fault of the file's
    }
  };
  const end = (code) => {
    server.close();
    try {
      process.kill(-browser.pid, 'SIGKILL');  // with all of its helpers
    } catch {
      // it never began
    }
    setTimeout(() => { clean(); process.exit(code); }, 1000);
  };
  const conclude = (answer) => {
    try {
      if (answer.error) throw new Error(answer.error);
      judge(answer);
      end(0);
    } catch (error) {
      console.log(`${what}: ${error.message}`);
      end(1);
    }
  };
  const answer = (path) => {
    if (path === '/') return [readFileSync(join(here, page)), kinds['.html']];
    if (path.startsWith('/three/')) return [readFileSync(join(modules, normalize(path))), kinds[extname(path)] ?? 'text/plain'];
    const body = serve(path);
    return body === undefined ? undefined : [body, kinds[extname(path)] ?? 'application/octet-stream'];
  };
  const server = createServer((request, response) => {
    const url = new URL(request.url, 'http://localhost');
    if (request.method === 'POST') {
      const parts = [];
      request.on('data', (part) => parts.push(part)).on('end', () => {
        const body = Buffer.concat(parts);
        response.end();
        if (url.pathname === '/done') conclude(JSON.parse(body));
        else take(url, new Float32Array(body.buffer.slice(body.byteOffset, body.byteOffset + body.length)));
      });
      return;
    }
    let found;
    try {
      found = answer(decodeURIComponent(url.pathname));
    } catch {
      found = undefined;
    }
    if (found) response.writeHead(200, { 'Content-Type': found[1] }).end(found[0]);
    else response.writeHead(404).end();
  });
  server.listen(0, '127.0.0.1', () => {
    browser = spawn('chromium', ['--headless=new', '--no-sandbox', '--disable-gpu-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
      '--disable-background-networking', `--user-data-dir=${scratch}`, `http://127.0.0.1:${server.address().port}/`], { stdio: 'ignore', detached: true });
    browser.on('error', (error) => { console.log(`chromium: ${error.message}`); end(1); });
  });
  setTimeout(() => { console.log(`${what}: nothing came back within ${seconds} s`); end(1); }, 1000 * seconds).unref();
}
