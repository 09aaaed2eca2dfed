#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// A school with two faults for the walker to find: an error on a page's console, and a link that the server cannot answer.
import { createServer } from "node:http";

const page = (body) => `<!DOCTYPE html><title>Bad</title><main>${body}</main>`;
const server = createServer((request, response) => {
    const at = request.url;
    response.setHeader("content-type", "text/html");
    if (request.method === "POST") {
        response.writeHead(303, { location: "/home" });
        return response.end();
    }
    if (at === "/login") return response.end(page('<form method="post"><input name="login"><input name="password" type="password"><button type="submit">In</button></form>'));
    if (at === "/broken") response.statusCode = 500;
    response.end(page(at === "/home" ? '<a href="/broken">broken</a> <a href="/sound">sound</a><script>console.error("a planted fault")</script>' : '<a href="/home">home</a>'));
});
server.listen(0, "127.0.0.1", () => console.log(`http://127.0.0.1:${server.address().port}`));
process.stdin.on("end", () => process.exit()).resume();
