// The board: a row for each light. board.show(mix) shows a mix; changed(index, settings) is called when the user sets a light,
// and before that touched(index), once its slider has the focus.
'use strict';
relume.makeBoard = function (list, lights, changed, touched) {
    const { mix: mixing } = relume;
    function element(kind, settings) {
        const made = document.createElement(kind);
        for (const [name, value] of Object.entries(settings))
            if (name in made) made[name] = value;
            else made.setAttribute(name, value);
        return made;
    }
    const digits = (v) => String(Number(v.toPrecision(4)));

    const middles = mixing.middles(lights);
    const rows = lights.map((light, i) => {
        const item = element('li', {});
        const name = element('label', { className: 'name', textContent: light.name, htmlFor: 'light' + i });
        const color = element('input', { type: 'color', 'aria-label': 'Colour of ' + light.name });
        const solo = element('button', { textContent: 'Solo', 'aria-label': 'Solo ' + light.name });
        const mute = element('button', { textContent: 'Mute', 'aria-label': 'Mute ' + light.name });
        const slider = element('input', { type: 'range', id: 'light' + i, min: '0', max: String(mixing.kSteps), step: '1' });
        const text = element('output', { htmlFor: 'light' + i });
        let shown = null;
        slider.addEventListener('input', () =>
            changed(i, { intensity: mixing.atSlider(Number(slider.value), middles[i]), muted: false }));
        slider.addEventListener('focus', () => touched(i));
        slider.addEventListener('dblclick', () => changed(i, { intensity: light.intensity }));
        color.addEventListener('input', () => changed(i, { color: mixing.fromHex(color.value) }));
        solo.addEventListener('click', () => changed(i, { solo: !shown.solo }));
        mute.addEventListener('click', () => changed(i, { muted: !shown.muted }));
        item.append(name, color, solo, mute, text, slider);
        const notes = [];
        if (light.members.length > 0) notes.push(`These lights share a layer: ${light.members.join(', ')}.`);
        if (light.stale) notes.push(`The layer does not show the scene as it is: ${light.stale}.`);
        if (light.mean.every((c) => c === 0)) notes.push('The light was off when its layer was baked: it brings none.');
        if (notes.length > 0) item.append(element('p', { className: 'note', textContent: notes.join(' ') }));
        list.append(item);
        return {
            show(state, shines) {
                shown = state;
                slider.value = String(Math.round(mixing.sliderOf(state.intensity, middles[i])));
                const words = digits(state.intensity) + (light.unit ? ' ' + light.unit.replace('^2', '\u00b2') : '');
                slider.setAttribute('aria-valuetext', words);
                text.textContent = words;
                color.value = mixing.toHex(state.color);
                solo.setAttribute('aria-pressed', String(state.solo));
                mute.setAttribute('aria-pressed', String(state.muted));
                item.classList.toggle('off', !shines);
            },
        };
    });
    return {
        show(mix) {
            const weights = mixing.weights(mix);
            rows.forEach((row, i) => row.show(mix[i], weights[i].some((w) => w !== 0)));
        },
    };
};
