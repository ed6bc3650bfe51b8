// Moves the camera: by mouse, by fingers and by keys. move.camera() returns where it is; changed() is called when it moved.
'use strict';
relume.makeMover = function (canvas, bounds, changed) {
    const { maths } = relume;
    const diagonal = maths.length(maths.sub(bounds.high, bounds.low));
    const kTurn = 3.0;     // [rad] across the picture's height
    const kKeyTurn = 0.06; // [rad] a key press
    const kStep = 0.15 * diagonal; // [m/s] of a flight
    let camera = null, flies = false, last = 0, pending = 0;
    const pointers = new Map(), keys = new Set();

    function set(next) {
        camera = next;
        changed();
    }
    const turn = (yaw, pitch) => set((flies ? maths.look : maths.orbit)(camera, yaw, pitch));
    function spread() { // middle of two fingers and their distance
        const [a, b] = [...pointers.values()];
        return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1) };
    }
    function closer(factor) {
        set(flies ? maths.fly(camera, [0, 0, (1 - factor) * 0.3 * diagonal]) : maths.zoom(camera, factor));
    }

    canvas.addEventListener('pointerdown', (event) => {
        canvas.focus({ preventScroll: true });
        try { canvas.setPointerCapture(event.pointerId); } catch { /* A pointer that is gone already needs no capture. */ }
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        event.preventDefault();
    });
    canvas.addEventListener('pointermove', (event) => {
        const at = pointers.get(event.pointerId);
        if (!at) return;
        const height = canvas.clientHeight;
        if (pointers.size === 2) {
            const before = spread();
            Object.assign(at, { x: event.clientX, y: event.clientY });
            const after = spread();
            camera = maths.pan(camera, (before.x - after.x) / height, (after.y - before.y) / height);
            closer(before.apart / after.apart);
            return;
        }
        const dx = (event.clientX - at.x) / height, dy = (event.clientY - at.y) / height;
        Object.assign(at, { x: event.clientX, y: event.clientY });
        if (pointers.size > 2) return;
        if (event.buttons & 6 || event.shiftKey) set(maths.pan(camera, -dx, dy));
        else turn(-kTurn * dx, flies ? -kTurn * dy : kTurn * dy);
    });
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'])
        canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
        closer(Math.exp(Math.min(Math.max(event.deltaY, -200), 200) * 0.0015));
        event.preventDefault();
    }, { passive: false });

    const moves = { w: [0, 0, 1], s: [0, 0, -1], a: [-1, 0, 0], d: [1, 0, 0], e: [0, 1, 0], q: [0, -1, 0] };
    function glide(time) {
        pending = 0;
        if (keys.size === 0) return;
        const seconds = Math.min((time - last) / 1000, 0.1);
        last = time;
        let way = [0, 0, 0];
        for (const key of keys) way = maths.add(way, moves[key]);
        set(maths.fly(camera, maths.scale(way, kStep * seconds)));
        pending = requestAnimationFrame(glide);
    }
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    canvas.addEventListener('keydown', (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const key = event.key.toLowerCase();
        if (event.key in turns) {
            const [x, y] = turns[event.key];
            turn(-kKeyTurn * x, (flies ? 1 : -1) * -kKeyTurn * y);
        } else if (key === '+' || key === '=') closer(0.9);
        else if (key === '-') closer(1 / 0.9);
        else if (key in moves) {
            keys.add(key);
            if (!pending) {
                last = performance.now();
                pending = requestAnimationFrame(glide);
            }
        } else return;
        event.preventDefault();
    });
    canvas.addEventListener('keyup', (event) => keys.delete(event.key.toLowerCase()));
    canvas.addEventListener('blur', () => keys.clear());
    return { camera: () => camera, set, flies: () => flies, setFlies: (on) => { flies = on; } };
};
