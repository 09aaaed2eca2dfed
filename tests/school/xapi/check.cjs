// SPDX-License-Identifier: Apache-2.0
// node check.cjs FILE...: every statement through npm's xAPI validator; and a fault put into each is found.
const fs = require("fs");
const warningsOf = require("@learninglocker/xapi-validation").default;
let count = 0, wrong = 0;
for (const file of process.argv.slice(2))
    for (const statement of JSON.parse(fs.readFileSync(file, "utf8"))) {
        ++count;
        const warnings = warningsOf(statement, []);
        if (warnings.length) ++wrong, console.error(statement.id, JSON.stringify(warnings));
        const faulty = structuredClone(statement);
        faulty.actor.mbox = "nobody";
        if (!warningsOf(faulty, []).length) ++wrong, console.error("the validator sees nothing");
    }
console.log(`${count} statements, ${wrong} wrong`);
process.exit(count > 0 && wrong === 0 ? 0 : 1);
