// SPDX-License-Identifier: Apache-2.0
/**
 * A picture of a page with a review, for the documents: node picture.mjs PAGE.html PICTURE.png [expression of the page ...]
 * @module
 */
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Browser } from "./browser.mjs";

const [page, picture, ...doing] = process.argv.slice(2);
const browser = new Browser({ webgl: true, width: 1366, height: 860 });
try {
    await browser.open(pathToFileURL(resolve(page)).href);
    await browser.until(`document.querySelector(".review-play")`);
    for (const expression of [`document.querySelector(".review").scrollIntoView()`, ...doing]) await browser.evaluate(expression);
    await browser.evaluate(`new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))`);
    writeFileSync(picture, await browser.picture());
} finally {
    await browser.close();
}
