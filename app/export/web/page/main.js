// Starts the page, and keeps what is shown: two mixes, the camera, the exposure, the wipe. relume.page is what the
// controls call, and what tests may call, too.
'use strict';
relume.start = async function (base64) {
    const at = (id) => document.getElementById(id);
    const message = at('message');
    try {
        const data = await relume.unpack(base64);
        relume.page = await relume.makePage(at, data);
        message.textContent = '';
        document.body.dataset.ready = '1';
    } catch (error) {
        message.textContent = error.message;
        document.body.dataset.failed = error.message;
    }
};

relume.makePage = async function (at, data) {
    const { mix: mixing } = relume;
    const { header } = data;
    const canvas = at('picture'), lights = header.lights;
    const drawing = await relume.makeDrawing(canvas, data);
    const beginning = mixing.start(lights);
    let mixes = [beginning, beginning], side = 0, wipe = null, glow = true, exposure = 0;

    // ---- frames: while something moves, a slow device draws fewer pixels; when all is still, it draws them all ----
    const kSlow = 60, kFast = 25; // [ms] of a frame
    const kLeast = 0.25;          // of the pixels along each edge
    let share = 1, requested = false, settle = 0, frameTimes = [], askedAt = 0;
    const sides = () => (wipe === null ? [[side, 0, 1]] : [[0, 0, wipe], [1, wipe, 1]]);
    const state = () => ({ camera: mover.camera(), exposure, glow, sides: sides() });
    function mixNow() {
        for (const [each] of sides()) drawing.mix(each, mixing.weights(mixes[each]));
    }
    function fit() {
        const ratio = Math.min(devicePixelRatio || 1, 2);
        const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
        const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
        if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    }
    function drawNow(part = 1) {
        fit();
        mixNow();
        drawing.show(state(), part);
    }
    function frame() {
        requested = false;
        const start = performance.now();
        drawNow(share);
        drawing.finish();
        const end = performance.now(), took = end - start;
        frameTimes.push(end - askedAt);
        if (frameTimes.length > 100) frameTimes.shift();
        if (took > kSlow) share = Math.max(kLeast, share * Math.max(0.5, Math.sqrt(0.7 * kSlow / took)));
        else if (took < kFast) share = Math.min(1, share * 1.25);
        clearTimeout(settle);
        if (share < 1) settle = setTimeout(() => drawNow(1), 250);
    }
    function changed() {
        if (requested) return;
        requested = true;
        askedAt = performance.now();
        clearTimeout(settle);
        requestAnimationFrame(frame);
    }

    // What a control changes is seen, in place of a picture of the bake on its way.
    function changedByUser() {
        at('frame').hidden = true;
        changed();
    }

    // ---- what is shown ----
    const board = relume.makeBoard(at('lights'), lights, (index, settings) => setLight(index, settings),
        (index) => drawing.hold(side, index));
    // A camera that moved is none of the list any more, so that the one it was can be chosen again.
    const mover = relume.makeMover(canvas, header.bounds, () => {
        at('camera').selectedIndex = -1;
        changedByUser();
    });
    const press = (id, on) => at(id).setAttribute('aria-pressed', String(on));
    function showMix() {
        board.show(mixes[side]);
        at('command').hidden = true; // it is of another mix
        changedByUser();
    }
    function setLight(index, settings) {
        mixes = mixes.map((mix, i) => (i === side ? mixing.changed(mix, index, settings) : mix));
        showMix();
    }
    function setMix(mix) {
        mixes = mixes.map((old, i) => (i === side ? mix : old));
        showMix();
    }
    function setSide(next) {
        side = next;
        press('mixA', side === 0);
        press('mixB', side === 1);
        showMix();
    }
    function setWipe(place) {
        wipe = place === null ? null : Math.min(Math.max(place, 0), 1);
        at('wipe').hidden = wipe === null;
        press('compare', wipe !== null);
        if (wipe !== null) {
            at('wipe').style.left = 100 * wipe + '%';
            at('wipe').setAttribute('aria-valuenow', String(Math.round(100 * wipe)));
        }
        changedByUser();
    }
    function setExposure(value) {
        exposure = value;
        at('exposure').value = String(value);
        at('exposureText').textContent = (value >= 0 ? '+' : '\u2212') + Math.abs(value).toFixed(2) + ' EV';
        changedByUser();
    }
    function measure() {
        fit();
        mixNow();
        return relume.measuredExposure(drawing, { ...state(), sides: [[side, 0, 1]] }, canvas.width / canvas.height);
    }
    function setCamera(camera) {
        mover.set(camera);
        at('camera').selectedIndex = header.cameras.indexOf(camera);
    }
    function setGlow(on) {
        glow = on;
        press('glow', glow);
        changedByUser();
    }
    function setFlies(on) {
        mover.setFlies(on);
        press('fly', on);
    }

    // ---- controls ----
    at('view').open = innerWidth > 720 && innerHeight > 480; // small screens have room for the lights first
    at('mixA').onclick = () => setSide(0);
    at('mixB').onclick = () => setSide(1);
    at('compare').onclick = () => setWipe(wipe === null ? 0.5 : null);
    at('reset').onclick = () => setMix(beginning);
    at('glow').onclick = () => setGlow(!glow);
    at('fly').onclick = () => setFlies(!mover.flies());
    canvas.addEventListener('keydown', (event) => {
        if (event.key.toLowerCase() === 'f' && !event.ctrlKey && !event.metaKey && !event.altKey) setFlies(!mover.flies());
    });
    header.cameras.forEach((camera, i) =>
        at('camera').append(new Option(camera.name || 'Camera ' + (i + 1), String(i))));
    at('camera').onchange = () => setCamera(header.cameras[Number(at('camera').value)]);
    at('exposure').oninput = () => setExposure(Number(at('exposure').value));
    at('measure').onclick = () => setExposure(measure());

    const handle = at('wipe');
    handle.addEventListener('pointerdown', (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener('pointermove', (event) => {
        if (!event.buttons) return;
        const box = canvas.getBoundingClientRect();
        setWipe((event.clientX - box.left) / box.width);
    });
    handle.addEventListener('keydown', (event) => {
        const step = { ArrowLeft: -0.02, ArrowRight: 0.02, ArrowDown: -0.02, ArrowUp: 0.02 }[event.key];
        if (step === undefined) return;
        setWipe(wipe + step);
        event.preventDefault();
    });

    at('copy').onclick = async () => {
        const text = mixing.command(header.layers, lights, mixes[side]);
        Object.assign(at('command'), { value: text, hidden: false });
        at('command').select();
        try {
            await navigator.clipboard.writeText(text);
        } catch { /* Where a page may not write there, the text is selected and the user copies it. */ }
    };

    // ---- pictures of the bake on its way ----
    let shownFrame = null;
    if (header.frames.length > 0) {
        at('scrubber').hidden = false;
        at('moment').max = String(header.frames.length - 1);
        at('moment').value = at('moment').max;
        at('momentText').textContent = `${header.frames.length} pictures`;
        at('moment').oninput = () => {
            const { number, picture } = header.frames[Number(at('moment').value)];
            if (shownFrame) URL.revokeObjectURL(shownFrame);
            shownFrame = URL.createObjectURL(data.picture(picture));
            at('frame').src = shownFrame;
            at('frame').hidden = false;
            at('momentText').textContent = `picture ${number}`;
        };
    }
    at('frame').onclick = () => { at('frame').hidden = true; };

    canvas.addEventListener('webglcontextlost', () => {
        at('message').textContent = 'The graphics device was lost: load the page again.';
    });
    new ResizeObserver(changed).observe(canvas);

    fit();
    setCamera(header.cameras[0]);
    board.show(mixes[0]);
    const wanted = header.exposure ?? measure();
    at('exposure').min = String(Math.floor(wanted - 6));
    at('exposure').max = String(Math.ceil(wanted + 6));
    setExposure(wanted);
    drawNow(1);
    return {
        lights, cameras: header.cameras, drawNow, setLight, setMix, setSide, setWipe, setExposure, setCamera, setGlow, setFlies,
        measure, beginning, mixes: () => mixes, camera: mover.camera, exposure: () => exposure, frameTimes: () => frameTimes,
        share: () => share,
        // Returns a picture of so many pixels as displayed: rows from the top, R, G and B.
        pixels(width, height) {
            mixNow();
            return drawing.pixels(state(), width, height);
        },
    };
};
