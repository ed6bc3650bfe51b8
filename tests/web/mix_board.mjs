// Opens an exported page with a mix board from the disk, in headless Chromium, and does what its job says.
//
//     node mix_board.mjs PAGE.html JOB.json FOLDER
//
// JOB: { width, height, exposure, mixes: [[{ intensity, color }, ...], ...], glow, touch, keys, slides, skies: [[words, width, height,
// most], ...] }. FOLDER gets `mixN.rgb` of each mix
// (rows from the top, R, G and B, as displayed), `page.png` and result.json: what was asked from a network, the errors, how long it
// took from a slider to its frame, what keys and fingers did, whether the page scrolls sideways.
import { readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const kPatience = 240000; // [ms], as software draws where other programs run
const [page, jobFile, folder] = process.argv.slice(2);
const job = JSON.parse(await readFile(jobFile, 'utf8'));
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-background-networking',
        '--disable-component-update', '--disable-sync', '--force-color-profile=srgb'],
});
const result = { requests: [], errors: [], slides: [] };
try {
    const context = await browser.newContext({
        viewport: { width: job.viewport[0], height: job.viewport[1] }, hasTouch: job.touch ?? false, isMobile: job.touch ?? false,
    });
    const tab = await context.newPage();
    tab.on('pageerror', (error) => result.errors.push(error.stack ?? error.message));
    tab.on('console', (message) => { if (message.type() === 'error') result.errors.push(message.text()); });
    tab.on('request', (request) => {
        if (!/^(file|data|blob):/.test(request.url())) result.requests.push(request.url());
    });
    await tab.goto(pathToFileURL(page).href);
    await tab.waitForSelector('body[data-ready], body[data-failed]', { state: 'attached', timeout: kPatience });
    result.failed = await tab.evaluate(() => document.body.dataset.failed ?? '');
    result.measured = await tab.evaluate(() => relume.page.measure());
    if (job.exposure !== undefined) await tab.evaluate((value) => relume.page.setExposure(value), job.exposure);
    for (const [i, mix] of (job.mixes ?? []).entries()) {
        const text = await tab.evaluate(({ lights, width, height, glow }) => {
            const { page: shown } = relume;
            shown.setGlow(glow);
            lights.forEach((settings, index) => shown.setLight(index, settings));
            const from = shown.pixels(width, height);
            let letters = '';
            for (let y = height - 1; y >= 0; --y)
                for (let x = 0; x < width; ++x)
                    for (let c = 0; c < 3; ++c) letters += String.fromCharCode(from[4 * (y * width + x) + c]);
            return btoa(letters);
        }, { lights: mix, width: job.width, height: job.height, glow: job.glow ?? false });
        await writeFile(join(folder, `mix${i}.rgb`), Buffer.from(text, 'base64'));
    }
    if (job.skies)
        result.skies = await tab.evaluate((skies) => skies.map(([words, width, height, most]) => {
            const small = relume.shrink.sky(new Uint32Array(words), width, height, most);
            return [Array.from(small.words), small.width, small.height];
        }), job.skies);
    // Each slide waits for the frame after the one that it asks for: what it shows was handed to the screen by then.
    for (let i = 0; i < (job.slides ?? 0); ++i)
        result.slides.push(await tab.evaluate(async (position) => {
            const frame = () => new Promise((done) => requestAnimationFrame(done));
            await frame();
            const sliders = document.querySelectorAll('#lights input[type=range]');
            const slider = sliders[Math.floor(position / 8) % sliders.length]; // dragged by eight steps
            slider.focus();
            const start = performance.now();
            slider.value = String(40 + (37 * position) % 120);
            slider.dispatchEvent(new Event('input'));
            await frame();
            await frame();
            return performance.now() - start;
        }, i));
    // Turned one by one, the mix must be the one that all layers together make.
    if (job.slides)
        result.drift = await tab.evaluate(() => {
            const { page: shown } = relume;
            const mix = shown.mixes()[0], turned = shown.pixels(320, 180);
            shown.setMix(shown.beginning);
            shown.pixels(320, 180);
            shown.setMix(mix);
            const whole = shown.pixels(320, 180);
            return whole.reduce((most, v, i) => Math.max(most, i % 4 === 3 ? 0 : Math.abs(v - turned[i])), 0);
        });
    if (job.slides) result.share = await tab.evaluate(() => relume.page.share());
    result.sideways = await tab.evaluate(() =>
        document.documentElement.scrollWidth > innerWidth || document.querySelector('#board').scrollWidth > document.querySelector('#board').clientWidth);
    const state = () => tab.evaluate(() => ({ camera: relume.page.camera(), lights: relume.page.mixes()[0] }));
    if (job.keys) {
        result.before = await state();
        await tab.focus('#light0');
        await tab.keyboard.press('ArrowRight');
        await tab.keyboard.press('ArrowRight');
        await tab.keyboard.press('Tab'); // to the next light's colour
        await tab.keyboard.press('Tab'); // to its solo
        await tab.keyboard.press('Space');
        await tab.focus('#picture');
        await tab.keyboard.press('ArrowLeft');
        result.afterKeys = await state();
        await tab.keyboard.press('+');
        result.afterPlus = await state();
        const camera = () => tab.evaluate(() => document.querySelector('#camera').selectedIndex);
        result.cameraMoved = await camera();
        await tab.selectOption('#camera', '0');
        result.afterChoice = await state();
        result.cameraChosen = await camera();
        // Each of these is to be seen, although a picture of the bake on its way hides the scene.
        if (await tab.isVisible('#scrubber')) {
            result.hides = [];
            for (const control of ['#mixB', '#compare', '#reset', '#glow', '#measure']) {
                await tab.evaluate(() => document.querySelector('#moment').dispatchEvent(new Event('input')));
                const shown = await tab.isVisible('#frame');
                await tab.click(control);
                if (shown && !await tab.isVisible('#frame')) result.hides.push(control);
            }
            await tab.click('#copy');
            await tab.click('#mixA');
            result.oldCommand = await tab.isVisible('#command');
        }
        result.unlabelled = await tab.evaluate(() => [...document.querySelectorAll('input, select, button, textarea')]
            .filter((control) => !(control.labels?.length || control.getAttribute('aria-label') || control.textContent.trim())).length);
    }
    if (job.touch) {
        const session = await context.newCDPSession(tab);
        const touch = (type, ...points) => session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
        result.before = await state();
        await touch('touchStart', [150, 150]);
        await touch('touchMove', [190, 160]);
        await touch('touchEnd');
        result.afterOne = await state();
        await touch('touchStart', [150, 150], [200, 150]);
        await touch('touchMove', [130, 150], [240, 150]);
        await touch('touchEnd');
        result.afterTwo = await state();
        await tab.tap('#lights li:nth-child(2) button:nth-of-type(2)');
        result.afterTap = await state();
    }
    await tab.evaluate(() => relume.page.drawNow(1));
    await tab.screenshot({ path: join(folder, 'page.png'), timeout: kPatience });
} catch (error) {
    result.errors.push(error.message);
} finally {
    await browser.close();
}
await writeFile(join(folder, 'result.json'), JSON.stringify(result));
