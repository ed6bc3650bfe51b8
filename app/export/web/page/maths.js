// Vectors are arrays of three, matrices arrays of sixteen by columns, as WebGL takes them. Cameras move as those of the
// program do: a camera is { eye, target, up, yfov, halfHeight, znear, zfar }, and what moves it returns another one.
'use strict';
relume.maths = (function () {
    const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const length = (a) => Math.hypot(a[0], a[1], a[2]);
    const normalize = (a) => scale(a, 1 / length(a));
    const luminance = (c) => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];

    // Returns v turned by an angle about a unit axis [Rodrigues].
    function rotated(v, angle, axis) {
        const c = Math.cos(angle), s = Math.sin(angle);
        return add(add(scale(v, c), scale(cross(axis, v), s)), scale(axis, dot(axis, v) * (1 - c)));
    }
    function multiply(a, b) {
        const out = new Float32Array(16);
        for (let column = 0; column < 4; ++column)
            for (let row = 0; row < 4; ++row)
                for (let k = 0; k < 4; ++k) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
        return out;
    }

    const forward = (camera) => normalize(sub(camera.target, camera.eye));
    function right(camera) {
        const ahead = forward(camera), side = cross(ahead, camera.up);
        if (length(side) > 1e-5) return normalize(side);
        const other = Math.abs(ahead[0]) < 0.5 ? [1, 0, 0] : [0, 0, 1];
        return normalize(cross(ahead, cross(other, ahead)));
    }
    const above = (camera) => cross(right(camera), forward(camera));

    function viewMatrix(camera) {
        const a = forward(camera), r = right(camera), u = cross(r, a), e = camera.eye;
        return [r[0], u[0], -a[0], 0, r[1], u[1], -a[1], 0, r[2], u[2], -a[2], 0, -dot(r, e), -dot(u, e), dot(a, e), 1];
    }
    // Returns the projection. With `reversed`, depth runs from 1 at znear to 0 far away, as the program has it. Without,
    // it is WebGL's usual one, and farthest tells how far away the scene ends.
    function projectionMatrix(camera, aspect, reversed, farthest) {
        const m = new Float32Array(16);
        const near = camera.znear;
        if (camera.halfHeight > 0) {
            const depth = camera.zfar - near;
            m[0] = 1 / (camera.halfHeight * aspect);
            m[5] = 1 / camera.halfHeight;
            m[10] = reversed ? 1 / depth : -2 / depth;
            m[14] = reversed ? camera.zfar / depth : -(camera.zfar + near) / depth;
            m[15] = 1;
            return m;
        }
        const cotangent = 1 / Math.tan(0.5 * camera.yfov);
        m[0] = cotangent / aspect;
        m[5] = cotangent;
        m[10] = reversed ? 0 : -(farthest + near) / (farthest - near);
        m[11] = -1;
        m[14] = reversed ? near : -2 * farthest * near / (farthest - near);
        return m;
    }

    function turned(offset, camera, yaw, pitch) {
        const margin = 0.01; // to the poles, where yaw has no meaning
        const size = length(offset);
        const angle = Math.acos(Math.min(Math.max(dot(offset, camera.up) / size, -1), 1));
        const wanted = Math.min(Math.max(angle - pitch, margin), Math.PI - margin);
        let flat = cross(right(camera), camera.up);
        if (dot(flat, offset) < 0) flat = scale(flat, -1);
        flat = rotated(flat, yaw, camera.up);
        return scale(add(scale(camera.up, Math.cos(wanted)), scale(flat, Math.sin(wanted))), size);
    }
    const orbit = (camera, yaw, pitch) =>
        ({ ...camera, eye: add(camera.target, turned(sub(camera.eye, camera.target), camera, yaw, pitch)) });
    const look = (camera, yaw, pitch) =>
        ({ ...camera, target: add(camera.eye, turned(sub(camera.target, camera.eye), camera, yaw, pitch)) });
    function moved(camera, step) {
        return { ...camera, eye: add(camera.eye, step), target: add(camera.target, step) };
    }
    // Moves by shares of the picture's height at the target.
    function pan(camera, dx, dy) {
        const height = camera.halfHeight > 0 ? 2 * camera.halfHeight
            : 2 * length(sub(camera.eye, camera.target)) * Math.tan(0.5 * camera.yfov);
        return moved(camera, add(scale(right(camera), height * dx), scale(above(camera), height * dy)));
    }
    function zoom(camera, factor) {
        if (camera.halfHeight > 0) return { ...camera, halfHeight: camera.halfHeight * factor };
        return { ...camera, eye: add(camera.target, scale(sub(camera.eye, camera.target), factor)) };
    }
    // Moves by metres to the right, up and forward.
    const fly = (camera, [x, y, z]) =>
        moved(camera, add(add(scale(right(camera), x), scale(camera.up, y)), scale(forward(camera), z)));

    return { add, sub, scale, dot, length, luminance, multiply, forward, right, above, viewMatrix, projectionMatrix, orbit, look,
        pan, zoom, fly };
})();
