// Opens a page of a folder in headless Chromium and saves a picture of it.
//
//     node show.mjs FOLDER PAGE PICTURE.png WIDTHxHEIGHT
//
// PAGE is a file of the folder, with #options behind it, or one of this folder: @tests/NAME. The page says by data-ready
// on its body that it has drawn. What it would load from a public server comes from node_modules: nothing is asked from
// the network. Whatever the page logs as an error, and a page that never gets ready, ends this with status 1.
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const [folder, page, picture, size] = process.argv.slice(2);
const kPatience = 240000; // [ms], as software draws where other programs run
const [width, height] = size.split('x').map(Number);
const here = fileURLToPath(new URL('.', import.meta.url));
const kinds = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.json': 'application/json',
    '.glb': 'model/gltf-binary', '.wasm': 'application/wasm' };
const kindOf = (path) => kinds[extname(path)] ?? 'application/octet-stream';

const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    try {
        const file = path.startsWith('/@tests/') ? join(here, path.slice(8)) : join(folder, path);
        const bytes = path === '/favicon.ico' ? '' : await readFile(file);
        response.writeHead(200, { 'content-type': kindOf(path) }).end(bytes);
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((listening) => server.listen(0, '127.0.0.1', listening));

const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-background-networking',
        '--disable-component-update', '--disable-sync', '--force-color-profile=srgb'],
});
let failed = false;
try {
    const tab = await browser.newPage({ viewport: { width, height } });
    tab.on('pageerror', (error) => { failed = true; console.error(error.stack ?? error.message); });
    tab.on('console', (message) => {
        if (message.type() === 'error') { failed = true; console.error(message.text()); }
    });
    await tab.route('https://cdn.jsdelivr.net/npm/**', async (route) => {
        // .../npm/NAME@VERSION/PATH
        const [, name, path] = new URL(route.request().url()).pathname.match(/^\/npm\/((?:@[^/]+\/)?[^@/]+)@[^/]+\/(.*)$/);
        const file = join(here, 'node_modules', name, path);
        await route.fulfill({ body: await readFile(file), contentType: kindOf(file), headers: { 'access-control-allow-origin': '*' } });
    });
    await tab.goto(`http://127.0.0.1:${server.address().port}/${page}`);
    await tab.waitForSelector('body[data-ready]', { state: 'attached', timeout: kPatience });
    await tab.screenshot({ path: picture, timeout: kPatience });
} catch (error) {
    failed = true;
    console.error(error.message);
} finally {
    await browser.close();
    server.close();
}
process.exitCode = failed ? 1 : 0;
