// Measures which exposure a picture asks for, as the program's renderer/exposure.cpp does.
'use strict';
relume.measuredExposure = function (drawing, state, aspect) {
    const kCells = 64, kMiddleGrey = 0.18, kDarkest = 1 / 64; // of the mean: black corners shall not brighten the rest
    const kLowest = -20, kSteps = 8;                          // of the code in a picture's A (shaders/lib/tone.glsl)
    const width = 6 * kCells, height = Math.max(kCells, Math.round(width / aspect));
    const pixels = drawing.meterPixels(state, width, height);
    const cells = new Map(); // sum of log2, number of pixels
    let sum = 0, count = 0;
    for (let y = 0; y < height; ++y)
        for (let x = 0; x < width; ++x) {
            const code = pixels[4 * (y * width + x) + 3];
            if (code === 0) continue;
            const bright = (code - 1) / kSteps + kLowest;
            const key = Math.floor(y * kCells / height) * kCells + Math.floor(x * kCells / width);
            const cell = cells.get(key) ?? [0, 0];
            cells.set(key, [cell[0] + bright, cell[1] + 1]);
            sum += 2 ** bright;
            count += 1;
        }
    const mean = drawing.meanOf(state.sides[0][0]);
    const ofMean = mean > 0 ? -Math.log2(mean) : 0; // which the codes are relative to
    if (count === 0) return ofMean; // only the sky is seen
    const darkest = Math.log2(kDarkest * sum / count);
    let logs = 0;
    for (const [log, number] of cells.values()) logs += number * Math.max(log / number, darkest);
    return Math.log2(kMiddleGrey) - logs / count + ofMean;
};
