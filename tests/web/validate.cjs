// Prints one line for each error and warning that Khronos' glTF validator has about these files.
//
//     node validate.cjs FILE.glb...
const { validateBytes } = require('gltf-validator');
const { readFileSync } = require('node:fs');

const kWarning = 1; // severity; 0: error

(async () => {
    for (const file of process.argv.slice(2)) {
        const { issues } = await validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 0 });
        for (const issue of issues.messages)
            if (issue.severity <= kWarning) console.log(`${file}: ${issue.code} ${issue.pointer ?? ''}: ${issue.message}`);
    }
})();
