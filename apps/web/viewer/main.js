// SPDX-License-Identifier: Apache-2.0
/**
 * The viewer of a page that holds its review: docs/review.md.
 * @module
 */
import { bytesOf, unpackReview } from "./review.js";
import { ReviewPage } from "./page.js";

async function begin() {
    const host = document.getElementById("review"), text = document.getElementById("review-text"), data = document.getElementById("review-data");
    if (!host || !text || !data) return;
    const pictures = [...document.querySelectorAll("#review-pictures figure")].flatMap((figure) => {
        const picture = figure.querySelector("img"), timeS = Number(/** @type {HTMLElement} */ (figure).dataset.time);
        return picture ? [{ picture, timeS }] : [];
    });
    try {
        const review = await unpackReview(JSON.parse(text.textContent ?? ""), bytesOf(data.textContent ?? ""));
        new ReviewPage(host, review, pictures);
    } catch (error) {
        const message = document.createElement("p");
        message.className = "review-message";
        message.setAttribute("role", "alert");
        message.textContent = `${host.dataset.failed ?? ""} ${error instanceof Error ? error.message : error}`;
        host.replaceChildren(message);
    }
}
begin();
