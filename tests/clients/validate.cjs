// node validate.cjs NODE_MODULES FILE.glb   Exit code 1 when the Khronos validator finds an error or a warning.
const [, , modules, file] = process.argv;
const validator = require(require('path').join(modules, 'gltf-validator'));
validator.validateBytes(new Uint8Array(require('fs').readFileSync(file)), { maxIssues: 50 }).then((report) => {
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  for (const message of messages) if (message.severity < 2) console.log(`${message.code} ${message.pointer}: ${message.message}`);
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos`);
  process.exit(numErrors + numWarnings > 0 ? 1 : 0);
});
