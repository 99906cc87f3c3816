// node three_looks.mjs NODE_MODULES FILE.glb [PICTURES_FOLDER]
// Shows a character in three.js in a real browser (headless Chromium) from three sides, with skin and without: exit code 1 where tissues or their colours
// are missing, or where a light file needs more draw calls or triangles than it may.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { browse, document } from './browser.mjs';

const [, , modules, file, pictures] = process.argv;
const most_triangles = { medium: 150000, low: 60000 }[document(file).scenes[0].extras.ecorche.detail];
const tissues = ['bone', 'cartilage', 'eye_white', 'iris', 'muscle', 'pupil', 'skin', 'tendon'];

function judge(answer) {
  for (const view of answer.views)
    if (pictures) writeFileSync(join(pictures, `three-${view.name}.png`), Buffer.from(view.picture.split(',')[1], 'base64'));
  const most = Math.max(...answer.views.map((view) => view.calls)), triangles = Math.max(...answer.views.map((view) => view.triangles));
  console.log(`${file}: three.js r${answer.version}: ${most} draw calls, ${triangles} triangles; ${answer.tissues.length} materials`);
  if (answer.tissues.sort().join() !== tissues.join()) throw new Error(`materials: ${answer.tissues}`);
  if (answer.colored.sort().join() !== 'muscle,tendon') throw new Error(`vertices colour ${answer.colored}`);
  if (!answer.places) throw new Error('the skin has no place on a texture');
  if (most_triangles && (most > 40 || triangles > most_triangles)) throw new Error('that is not light');
  for (const view of answer.views) {
    const anatomy = view.name.startsWith('anatomy');
    if (view.lit < 0.1 || (anatomy && (view.red < 0.35 || view.pale < 0.12)) || (!anatomy && view.red > 0.1))
      throw new Error(`${view.name} looks wrong: ${JSON.stringify({ ...view, picture: 0 })}`);
  }
}

browse({ what: file, modules, page: 'three_looks.html', judge, serve: (path) => path === '/file.glb' ? readFileSync(file) : undefined, take: () => {} });
