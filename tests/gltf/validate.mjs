// node validate.mjs INSTALL_FOLDER SCRATCH_FOLDER: runs the Khronos validator over every .glb and .gltf below the
// scratch folder. Installs it into the install folder (of the build tree) first, once. Exits 1 on any error.
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const [installFolder, scratchFolder] = process.argv.slice(2);
if (!scratchFolder) {
  console.error('usage: node validate.mjs INSTALL_FOLDER SCRATCH_FOLDER');
  process.exit(2);
}

function skip(why) {
  console.log(`DFIELD TEST SKIPPED: ${why}`);
  process.exit(77);
}

function loadValidator() {
  const manifest = join(dirname(fileURLToPath(import.meta.url)), 'package.json');
  const wanted = JSON.parse(readFileSync(manifest)).dependencies['gltf-validator'];
  const require = createRequire(join(resolve(installFolder), 'package.json'));
  const installed = join(installFolder, 'node_modules', 'gltf-validator', 'package.json');
  if (!existsSync(installed) || JSON.parse(readFileSync(installed)).version !== wanted) {
    mkdirSync(installFolder, { recursive: true });
    copyFileSync(manifest, join(installFolder, 'package.json'));
    try {
      execFileSync('npm', ['install', '--no-package-lock', '--no-audit', '--no-fund', '--ignore-scripts',
        '--fetch-retries=1', '--fetch-timeout=30000'],
        { cwd: installFolder, stdio: ['ignore', 'ignore', 'pipe'], timeout: 120000 });
    } catch (error) {
      skip(`gltf-validator ${wanted} cannot be installed (npm without network?): ` +
        String(error.stderr ?? error.message).split('\n').find((line) => /error/i.test(line)));
    }
  }
  return require('gltf-validator');
}

function documents(folder) {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) return documents(path);
    return /\.(glb|gltf)$/i.test(entry.name) ? [path] : [];
  }).sort();
}

async function validate(validator, path) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), {
    uri: path,
    maxIssues: 100,
    externalResourceFunction: (uri) => new Promise((done, fail) => {
      try {
        done(new Uint8Array(readFileSync(join(dirname(path), decodeURIComponent(uri)))));
      } catch (error) {
        fail(String(error));
      }
    }),
  });
  const { numErrors, numWarnings, messages } = report.issues;
  console.log(`${numErrors ? 'FAIL' : 'ok  '} ${path}: ${numErrors} errors, ${numWarnings} warnings`);
  for (const message of messages)
    if (message.severity < 2)  // 0 = error, 1 = warning; what else it notes (unknown extensions, unused parts) is fine
      console.log(`     ${message.severity ? 'warning' : 'error'} ${message.code} ${message.pointer ?? ''}: ${message.message}`);
  return numErrors;
}

const validator = loadValidator();
const paths = existsSync(scratchFolder) ? documents(scratchFolder) : [];
if (paths.length === 0) {
  console.error(`no glTF files below ${scratchFolder}; run test_gltf_output first`);
  process.exit(1);
}
let errors = 0;
for (const path of paths) errors += await validate(validator, path);
console.log(`gltf-validator ${validator.version()}: ${paths.length} files, ${errors} errors`);
process.exit(errors ? 1 : 0);
