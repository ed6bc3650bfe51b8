// The mix: what `relume mix` does to the weights of the layers. A mix is a list with { intensity, color, muted, solo } of
// each light; intensities are in the light's unit, colours linear.
'use strict';
relume.mix = (function () {
    const decode = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    const encode = (v) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
    const isOff = (weight) => weight.every((w) => w === 0);

    // Returns the mix that the file of the layers has: a light that is off there is muted here.
    function start(lights) {
        return lights.map((light) => ({
            intensity: light.intensity, color: light.color.slice(), muted: isOff(light.weight), solo: false,
            weight: isOff(light.weight) ? null : light.weight,
        }));
    }
    // Returns the weights of the layers. As long as nobody sets a light's intensity or colour, its weight is the file's.
    function weights(mix) {
        const alone = mix.some((light) => light.solo);
        return mix.map((light) => {
            if (light.muted || (alone && !light.solo)) return [0, 0, 0];
            return light.weight ?? light.color.map((c) => c * light.intensity);
        });
    }
    // Returns the mix with some settings of a light changed.
    function changed(mix, index, settings) {
        const sets = 'intensity' in settings || 'color' in settings;
        return mix.map((light, i) => (i !== index ? light : { ...light, ...settings, weight: sets ? null : light.weight }));
    }
    // Returns the mean lighting of the patches, which lights what has no lightmap.
    function ambient(lights, shares) {
        const sum = [0, 0, 0];
        lights.forEach((light, i) => sum.forEach((_, c) => { sum[c] += light.mean[c] * shares[i][c]; }));
        return sum;
    }

    // Returns the intensities in the middle of the sliders, which are the lights' own. A light that has 0 in the file gets the
    // one at which it brings as much as all that shine there.
    function middles(lights) {
        const { luminance } = relume.maths;
        const all = luminance(ambient(lights, weights(start(lights))));
        return lights.map((light) => {
            if (light.intensity > 0) return light.intensity;
            const unit = luminance(light.mean.map((c, i) => c * light.color[i]));
            return all > 0 && unit > 0 ? all / unit : 1;
        });
    }

    // A slider's middle is the light's own intensity, its end eight times that; it is fine where a light is dim.
    const kSteps = 200;
    const atSlider = (position, own) => own * (2 * position / kSteps) ** 3;
    const sliderOf = (intensity, own) => (own > 0 ? Math.min(kSteps, 0.5 * kSteps * Math.cbrt(intensity / own)) : 0);

    const toHex = (color) => '#' + color.map((c) =>
        Math.round(255 * encode(Math.min(Math.max(c, 0), 1))).toString(16).padStart(2, '0')).join('');
    const fromHex = (text) => [1, 3, 5].map((at) => decode(parseInt(text.slice(at, at + 2), 16) / 255));

    const quoted = (text) => '\'' + text.replaceAll('\'', '\'\\\'\'') + '\'';
    const digits = (v) => String(Number(v.toPrecision(7)));
    // Returns the command that makes the same mix of the layers.
    function command(layers, lights, mix) {
        let text = 'relume mix ' + quoted(layers);
        lights.forEach((light, i) => {
            const now = mix[i];
            if (now.weight === null && !(now.muted && isOff(light.weight)))
                text += ' --set ' + quoted(light.name + '=' + digits(now.intensity) + ',' + now.color.map(digits).join(','));
            if (now.muted) text += ' --mute ' + quoted(light.name);
            if (now.solo) text += ' --solo ' + quoted(light.name);
        });
        return text + ' -o mixed.exr';
    }
    return { start, weights, changed, ambient, middles, kSteps, atSlider, sliderOf, toHex, fromHex, command };
})();
