// Draws the scene with WebGL 2. A drawing holds the scene and two mixed lightmaps, A and B.
'use strict';
relume.makeDrawing = async function (canvas, data) {
    const { maths, shaders } = relume;
    const { header } = data;
    const gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false });
    if (!gl) throw new Error('This browser has no WebGL 2: take a newer one, or turn on hardware acceleration.');
    if (!gl.getExtension('EXT_color_buffer_float') && !gl.getExtension('EXT_color_buffer_half_float'))
        throw new Error('This device cannot draw into half floats, which the mix needs.');
    const clip = gl.getExtension('EXT_clip_control'); // depth is then as fine far away as near by
    const anisotropic = gl.getExtension('EXT_texture_filter_anisotropic');
    const most = gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS), largest = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    const { lights, lightmap } = header;
    if (lights.length > most) throw new Error(`This device mixes ${most} lights at most, and there are ${lights.length}.`);
    if (lightmap.size > largest) throw new Error(`This device takes lightmaps up to ${largest}, and this one has ${lightmap.size}.`);

    // ---- programs ----
    function makeProgram(vertex, fragment, definitions) {
        const lines = Object.entries(definitions).map(([name, value]) => `#define ${name} ${value}\n`).join('');
        const program = gl.createProgram();
        for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, '#version 300 es\n' + lines + text);
            gl.compileShader(shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
                throw new Error('A shader does not compile: ' + gl.getShaderInfoLog(shader));
            gl.attachShader(program, shader);
        }
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
            throw new Error('A shader does not link: ' + gl.getProgramInfoLog(program));
        const places = {};
        const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
        for (let i = 0; i < count; ++i) {
            const name = gl.getActiveUniform(program, i).name;
            places[name.replace('[0]', '')] = gl.getUniformLocation(program, name);
        }
        return { program, places };
    }
    const programs = new Map();
    function programOf(vertex, fragment, definitions) {
        const key = fragment + JSON.stringify(definitions);
        if (!programs.has(key)) programs.set(key, makeProgram(vertex, fragment, definitions));
        return programs.get(key);
    }

    // ---- textures ----
    function makeTexture(target, wrapS, wrapT, min, mag) {
        const texture = gl.createTexture();
        gl.bindTexture(target, texture);
        gl.texParameteri(target, gl.TEXTURE_WRAP_S, wrapS);
        gl.texParameteri(target, gl.TEXTURE_WRAP_T, wrapT);
        gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, min);
        gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, mag);
        return texture;
    }
    gl.activeTexture(gl.TEXTURE0);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    const wraps = [gl.REPEAT, gl.MIRRORED_REPEAT, gl.CLAMP_TO_EDGE];
    const textures = [];
    for (const use of header.textures) {
        const bitmap = await relume.shrink.texture(data.picture(use.picture), largest);
        const texture = makeTexture(gl.TEXTURE_2D, wraps[use.wrapS], wraps[use.wrapT], gl.LINEAR_MIPMAP_LINEAR,
            use.nearest ? gl.NEAREST : gl.LINEAR);
        gl.texImage2D(gl.TEXTURE_2D, 0, use.srgb ? gl.SRGB8_ALPHA8 : gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
        gl.generateMipmap(gl.TEXTURE_2D);
        if (anisotropic)
            gl.texParameterf(gl.TEXTURE_2D, anisotropic.TEXTURE_MAX_ANISOTROPY_EXT,
                Math.min(8, gl.getParameter(anisotropic.MAX_TEXTURE_MAX_ANISOTROPY_EXT)));
        bitmap.close();
        textures.push(texture);
    }
    const { sky } = header;
    let skyPicture = null;
    if (sky.picture >= 0) {
        skyPicture = makeTexture(gl.TEXTURE_2D, gl.REPEAT, gl.CLAMP_TO_EDGE, gl.LINEAR, gl.LINEAR);
        const fitting = relume.shrink.sky(data.words(sky.picture), sky.width, sky.height, largest);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB9_E5, fitting.width, fitting.height, 0, gl.RGB, gl.UNSIGNED_INT_5_9_9_9_REV,
            fitting.words);
    }

    const none = gl.createVertexArray();
    // ---- lightmaps: a texture with all layers, and one for each mix ----
    const size = lightmap.size;
    const layers = makeTexture(gl.TEXTURE_2D_ARRAY, gl.CLAMP_TO_EDGE, gl.CLAMP_TO_EDGE, gl.NEAREST, gl.NEAREST);
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGB9_E5, size, size, lights.length);
    lights.forEach((light, i) => gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, i, size, size, 1, gl.RGB,
        gl.UNSIGNED_INT_5_9_9_9_REV, data.words(light.texels)));
    const covered = data.bytes(lightmap.coverage);
    const coverage = makeTexture(gl.TEXTURE_2D, gl.CLAMP_TO_EDGE, gl.CLAMP_TO_EDGE, gl.NEAREST, gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, size, size, 0, gl.RED, gl.UNSIGNED_BYTE, covered);
    // Tells whether no texel within two of a patch's is empty: filters then need not look.
    function isFilled() {
        for (let y = 0; y < size; ++y)
            for (let x = 0; x < size; ++x) {
                if (covered[y * size + x] < 192) continue;
                for (let v = Math.max(y - 2, 0); v <= Math.min(y + 2, size - 1); ++v)
                    for (let u = Math.max(x - 2, 0); u <= Math.min(x + 2, size - 1); ++u)
                        if (covered[v * size + u] === 0) return false;
            }
        return true;
    }
    const filled = isFilled() ? 1 : 0;
    function makeLightmap() {
        const texture = makeTexture(gl.TEXTURE_2D, gl.CLAMP_TO_EDGE, gl.CLAMP_TO_EDGE, gl.LINEAR, gl.LINEAR);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA16F, size, size);
        const framebuffer = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
        return { texture, framebuffer, shares: null, ambient: [0, 0, 0], unit: 1 };
    }
    // Each has the lightmap of its mix, and once a light is turned that of all others: then the next turn of it adds one
    // layer to that, whatever the number of lights.
    const mixed = [0, 1].map(() => ({ ...makeLightmap(), held: -1, rest: null }));

    // Sums the layers by these weights into a lightmap; rest: another lightmap that is added, with all its layers, or null.
    function sum(to, shares, rest) {
        const total = rest ? maths.add(rest.ambient, relume.mix.ambient(lights, shares)) : relume.mix.ambient(lights, shares);
        to.ambient = total;
        const mean = maths.luminance(total);
        to.unit = mean > 0 ? 2 ** Math.round(Math.log2(mean)) : 1; // half floats are finest near 1
        const used = lights.map((light, i) => [...shares[i].map((w) => w * 2 ** light.exponent / to.unit), i])
            .filter((weight) => weight[0] !== 0 || weight[1] !== 0 || weight[2] !== 0);
        const { program, places } = programOf('precision highp float;' + shaders.screenVertex, shaders.mixFragment,
            { REST: rest ? 1 : 0 });
        gl.useProgram(program);
        gl.bindFramebuffer(gl.FRAMEBUFFER, to.framebuffer);
        gl.viewport(0, 0, size, size);
        gl.disable(gl.DEPTH_TEST);
        gl.disable(gl.CULL_FACE);
        gl.disable(gl.SCISSOR_TEST);
        gl.bindVertexArray(none);
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, layers);
        gl.activeTexture(gl.TEXTURE1);
        gl.bindTexture(gl.TEXTURE_2D, coverage);
        gl.uniform1i(places.layers, 0);
        gl.uniform1i(places.coverage, 1);
        gl.uniform1f(places.depth, 0);
        gl.activeTexture(gl.TEXTURE3);
        gl.bindTexture(gl.TEXTURE_2D, rest ? rest.texture : null); // never the one that is drawn into
        if (rest) {
            gl.uniform1i(places.rest, 3);
            gl.uniform1f(places.restScale, rest.unit / to.unit);
        }
        gl.blendFunc(gl.ONE, gl.ONE);
        for (let first = 0; first === 0 || first < used.length; first += 64) {
            const some = used.slice(first, first + 64);
            if (first > 0) gl.enable(gl.BLEND);
            gl.uniform1i(places.count, some.length);
            if (some.length > 0) gl.uniform4fv(places.weights, some.flat());
            gl.uniform1f(places.share, first === 0 ? 1 : 0);
            gl.drawArrays(gl.TRIANGLES, 0, 3);
        }
        gl.disable(gl.BLEND);
    }
    const isSame = (a, b) => a.every((v, c) => v === b[c]);
    const kDark = [0, 0, 0];
    // Sums all lights but one, which is about to be turned.
    function hold(side, index) {
        const to = mixed[side];
        if (to.held === index || !to.shares) return;
        to.rest ??= makeLightmap();
        sum(to.rest, to.shares.map((share, i) => (i === index ? kDark : share)), null);
        to.held = index;
    }
    // Mixes the lights by these weights into lightmap A (0) or B (1).
    function mix(side, shares) {
        const to = mixed[side];
        const turned = to.shares ? shares.map((_, i) => i).filter((i) => !isSame(shares[i], to.shares[i])) : [];
        if (to.shares && turned.length === 0) return;
        to.shares = shares;
        if (turned.length !== 1) {
            to.held = -1;
            return sum(to, shares, null);
        }
        hold(side, turned[0]);
        sum(to, shares.map((share, i) => (i === to.held ? share : kDark)), to.rest);
    }

    // ---- triangles ----
    const vertices = gl.createVertexArray();
    gl.bindVertexArray(vertices);
    const { geometry } = header;
    const buffers = new Map();
    function attribute(place, number, components, usual) {
        if (number < 0) return gl.vertexAttrib4fv(place, usual);
        const bytes = components === 1; // a mark
        if (!buffers.has(number)) {
            buffers.set(number, gl.createBuffer());
            gl.bindBuffer(gl.ARRAY_BUFFER, buffers.get(number));
            gl.bufferData(gl.ARRAY_BUFFER, data.bytes(number), gl.STATIC_DRAW);
        }
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers.get(number));
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, components, bytes ? gl.UNSIGNED_BYTE : gl.FLOAT, false, 0, 0);
    }
    attribute(0, geometry.positions, 3);
    attribute(1, geometry.normals, 3, [0, 1, 0, 0]);
    attribute(2, geometry.baseUv, 2);
    attribute(3, geometry.emissionUv, 2);
    attribute(4, geometry.metallicUv, 2);
    attribute(5, geometry.lightmapUv, 2);
    attribute(6, geometry.colors, 4, [1, 1, 1, 1]);
    attribute(7, geometry.mapped, 1, [1, 0, 0, 0]);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, data.bytes(geometry.indices), gl.STATIC_DRAW);

    // Returns the square of how far the far end of a draw is.
    function farthest(draw, eye) {
        return [0, 1, 2].reduce((sum, c) =>
            sum + Math.max(Math.abs(draw.low[c] - eye[c]), Math.abs(draw.high[c] - eye[c])) ** 2, 0);
    }
    function setLight(places, pass) {
        gl.uniform1f(places.exposure, 2 ** pass.exposure);
        const mean = maths.luminance(pass.mixed.ambient);
        gl.uniform1f(places.meterScale, mean > 0 ? 1 / mean : 1);
    }
    // Returns what a draw emits: its material's light, or with `glow` that of its lamp as it is mixed.
    function emissionOf(draw, material, pass) {
        if (!pass.glow || draw.light < 0) return material.emission;
        const share = pass.mixed.shares[draw.light];
        return lights[draw.light].members.length > 0 ? material.emission.map((e, c) => e * share[c]) : share;
    }
    function drawTriangles(draws, pass) {
        gl.bindVertexArray(vertices);
        let last = null;
        for (const draw of draws) {
            const material = header.materials[draw.material];
            const has = (texture) => (texture >= 0 ? 1 : 0);
            const made = programOf('precision highp float;' + shaders.sceneVertex, shaders.sceneFragment, {
                BASE: has(material.baseTexture), EMISSION: has(material.emissionTexture), METALLIC: has(material.metallicTexture),
                MASKED: material.masked ? 1 : 0, MAPPED: draw.mapped, FILLED: filled, PANE: draw.pane ? 1 : 0,
            });
            const { program, places } = made;
            if (made !== last) {
                last = made;
                gl.useProgram(program);
                setLight(places, pass);
                gl.uniformMatrix4fv(places.viewProjection, false, pass.viewProjection);
                gl.uniform3fv(places.eye, pass.camera.eye);
                gl.uniform3fv(places.ambient, pass.mixed.ambient);
                gl.uniform1f(places.unit, pass.mixed.unit);
                gl.uniform1i(places.baseTexture, 0);
                gl.uniform1i(places.emissionTexture, 1);
                gl.uniform1i(places.metallicTexture, 2);
                gl.uniform1i(places.lightmap, 3);
            }
            [material.baseTexture, material.emissionTexture, material.metallicTexture].forEach((texture, i) => {
                gl.activeTexture(gl.TEXTURE0 + i);
                gl.bindTexture(gl.TEXTURE_2D, texture >= 0 ? textures[texture] : null);
            });
            gl.uniform4fv(places.baseColor, material.base);
            gl.uniform3fv(places.emission, emissionOf(draw, material, pass));
            gl.uniform1f(places.cutoff, material.cutoff);
            gl.uniform4f(places.surface, material.metallic, material.roughness, material.transmission, material.blends ? 1 : 0);
            if (draw.doubleSided) gl.disable(gl.CULL_FACE);
            else gl.enable(gl.CULL_FACE);
            gl.drawElements(gl.TRIANGLES, draw.count, gl.UNSIGNED_INT, 4 * draw.first);
        }
    }
    function drawSky(pass) {
        const radiance = pass.glow && sky.light >= 0 ? pass.mixed.shares[sky.light] : sky.radiance;
        if (radiance.every((c) => c === 0)) return;
        const { camera } = pass;
        const { program, places } = programOf('precision highp float;' + shaders.screenVertex, shaders.skyFragment,
            { PICTURE: skyPicture ? 1 : 0 });
        gl.useProgram(program);
        setLight(places, pass);
        const above = camera.halfHeight > 0 ? 0 : Math.tan(0.5 * camera.yfov);
        gl.uniform3fv(places.ahead, maths.forward(camera));
        gl.uniform3fv(places.across, maths.scale(maths.right(camera), above * pass.width / pass.height));
        gl.uniform3fv(places.above, maths.scale(maths.above(camera), above));
        gl.uniform2f(places.size, pass.width, pass.height);
        gl.uniform3fv(places.radiance, radiance);
        gl.uniform1f(places.rotation, sky.rotation);
        gl.uniform1f(places.depth, clip ? 0 : 1);
        gl.uniform1i(places.picture, 0);
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D, skyPicture);
        gl.bindVertexArray(none);
        gl.disable(gl.CULL_FACE);
        gl.depthFunc(clip ? gl.GEQUAL : gl.LEQUAL);
        gl.depthMask(false);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        gl.depthMask(true);
        gl.depthFunc(clip ? gl.GREATER : gl.LESS);
    }

    // ---- the picture ----
    const kSamples = Math.min(4, gl.getParameter(gl.MAX_SAMPLES)), kOne = 0; // 0: a buffer without multisampling
    const target = { width: 0, height: 0, samples: kOne, framebuffer: gl.createFramebuffer(), resolved: gl.createFramebuffer(),
        color: gl.createRenderbuffer(), depth: gl.createRenderbuffer(), texture: null };
    function resize(width, height, samples) {
        if (target.width === width && target.height === height && target.samples === samples) return;
        Object.assign(target, { width, height, samples });
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
        for (const [buffer, format, place] of [[target.color, gl.RGBA8, gl.COLOR_ATTACHMENT0],
            [target.depth, gl.DEPTH_COMPONENT32F, gl.DEPTH_ATTACHMENT]]) {
            gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
            gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
            gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
        }
        gl.deleteTexture(target.texture);
        gl.activeTexture(gl.TEXTURE0);
        target.texture = makeTexture(gl.TEXTURE_2D, gl.CLAMP_TO_EDGE, gl.CLAMP_TO_EDGE, gl.LINEAR, gl.LINEAR);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.resolved);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target.texture, 0);
    }
    function drawSide(pass, left, right) {
        gl.scissor(left, 0, right - left, pass.height);
        gl.activeTexture(gl.TEXTURE3);
        gl.bindTexture(gl.TEXTURE_2D, pass.mixed.texture);
        const sorted = header.draws.map((draw) => [farthest(draw, pass.camera.eye), draw]).sort((a, b) => a[0] - b[0])
            .map((pair) => pair[1]);
        drawTriangles(sorted.filter((draw) => !draw.pane), pass);
        drawSky(pass);
        const panes = sorted.filter((draw) => draw.pane).reverse(); // the farthest first, so that all of them show
        if (panes.length === 0) return;
        gl.enable(gl.BLEND);
        gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ZERO, gl.ONE);
        gl.depthMask(false);
        drawTriangles(panes, pass);
        gl.depthMask(true);
        gl.disable(gl.BLEND);
    }
    // Draws a picture of width x height pixels. state: { camera, exposure [EV], glow, sides: [[0 or 1, left, right], ...] },
    // the sides' borders as shares of the width.
    function render(state, width, height, samples = kSamples) {
        resize(width, height, samples);
        if (clip) clip.clipControlEXT(clip.LOWER_LEFT_EXT, clip.ZERO_TO_ONE_EXT);
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
        gl.viewport(0, 0, width, height);
        gl.disable(gl.SCISSOR_TEST);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(clip ? gl.GREATER : gl.LESS);
        gl.clearColor(0.11, 0.12, 0.13, 0);
        gl.clearDepth(clip ? 0 : 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.enable(gl.SCISSOR_TEST);
        const { camera } = state;
        const far = Math.sqrt(farthest(header.bounds, camera.eye));
        const projection = maths.projectionMatrix(camera, width / height, clip !== null, Math.max(far, 2 * camera.znear));
        const viewProjection = maths.multiply(projection, maths.viewMatrix(camera));
        for (const [side, left, right] of state.sides)
            drawSide({ camera, viewProjection, width, height, exposure: state.exposure, glow: state.glow, mixed: mixed[side] },
                Math.round(left * width), Math.round(right * width));
        gl.disable(gl.SCISSOR_TEST);
        gl.disable(gl.DEPTH_TEST);
        gl.disable(gl.CULL_FACE);
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target.framebuffer);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, target.resolved);
        gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    }
    // Draws a picture on the canvas, of `share` of its pixels along each edge.
    function show(state, share) {
        render(state, Math.max(1, Math.round(share * canvas.width)), Math.max(1, Math.round(share * canvas.height)));
        const { program, places } = programOf('precision highp float;' + shaders.screenVertex, shaders.showFragment, {});
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.useProgram(program);
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D, target.texture);
        gl.uniform1i(places.picture, 0);
        gl.uniform1f(places.depth, 0);
        gl.uniform2f(places.size, canvas.width, canvas.height);
        gl.bindVertexArray(none);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    function read(width, height) {
        const out = new Uint8Array(4 * width * height);
        gl.bindFramebuffer(gl.FRAMEBUFFER, target.resolved);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
        return out;
    }
    // Returns the pixels of a picture, the lowest row first, as displayed.
    function pixels(state, width, height) {
        render(state, width, height);
        return read(width, height);
    }
    // Returns the same with what the meter reads in A: of one sample, because the mean of a code and of none, as at edges
    // before the sky, would be the code of something dark.
    function meterPixels(state, width, height) {
        render(state, width, height, kOne);
        return read(width, height);
    }
    // Waits until all that was asked for is drawn.
    const finish = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    const meanOf = (side) => maths.luminance(mixed[side].ambient);
    return { mix, hold, show, pixels, meterPixels, finish, meanOf };
};
