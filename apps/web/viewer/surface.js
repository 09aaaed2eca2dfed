// SPDX-License-Identifier: Apache-2.0
/**
 * The surface of a grid of distances as triangles, chunk by chunk: a vertex in each cell that it passes through (surface
 * nets, after S. F. F. Gibson 1998), moved towards the planes of its crossings so that edges stay edges.
 * @module
 */
import { kMiddle } from "./review.js";

/** Cells along a chunk's edge. */
export const kChunk = 16;

/**
 * @typedef {object} Mesh in steps of the grid
 * @property {Float32Array} positions
 * @property {Float32Array} normals unit, out of the tooth
 * @property {Uint16Array} triangles
 */

const kSide = kChunk + 1;
const vertexOf = new Int32Array(kSide ** 3);
const corner = new Float32Array(8);
const slopes = new Float32Array(24);
const crossings = new Float32Array(36), planes = new Float32Array(36);
/** The twelve edges of a cell: from corner, to corner. Bit k of a corner: one step along axis k. */
const kEdges = [0, 1, 2, 3, 4, 5, 6, 7, 0, 2, 1, 3, 4, 6, 5, 7, 0, 4, 1, 5, 2, 6, 3, 7];
/** How often the vertex is moved towards the planes, and how far each time. */
const kMoves = 8, kShare = 0.7;

/**
 * @param {Uint8Array} distance a byte a node @param {[number, number, number]} nodes
 * @param {[number, number, number]} at chunk
 * @returns {Mesh | null} null: no surface passes through it
 */
export function meshOf(distance, nodes, at) {
    const [nx, ny, nz] = nodes, layer = nx * ny;
    const low = at.map((c) => c * kChunk), high = at.map((c, k) => Math.min((c + 1) * kChunk, nodes[k] - 1));
    /** @type {number[][]} */
    const [positions, normals, triangles] = [[], [], []];
    if (isEven(distance, nx, layer, low, high)) return null;
    vertexOf.fill(-1);
    const step = [1, nx, layer];
    for (let z = Math.max(low[2] - 1, 0); z < high[2]; ++z)
        for (let y = Math.max(low[1] - 1, 0); y < high[1]; ++y)
            for (let x = Math.max(low[0] - 1, 0); x < high[0]; ++x) {
                const node = x + nx * y + layer * z;
                let inside = 0;
                for (let c = 0; c < 8; ++c)
                    if (distance[node + (c & 1) + (c & 2 ? nx : 0) + (c & 4 ? layer : 0)] < kMiddle) inside |= 1 << c;
                if (inside === 0 || inside === 255) continue;
                vertexOf[x - low[0] + 1 + kSide * (y - low[1] + 1 + kSide * (z - low[2] + 1))] = positions.length / 3;
                addVertex(x, y, z, node);
            }
    if (!positions.length) return null;

    /**
     * Slopes at the cell's corners, by differences to the nodes beside them.
     * @param {number} x @param {number} y @param {number} z @param {number} node
     */
    function addVertex(x, y, z, node) {
        for (let c = 0; c < 8; ++c) {
            const dx = c & 1, dy = (c >> 1) & 1, dz = c >> 2, n = node + dx + nx * dy + layer * dz;
            corner[c] = distance[n] - kMiddle;
            slopes[3 * c] = distance[x + dx + 1 < nx ? n + 1 : n] - distance[x + dx > 0 ? n - 1 : n];
            slopes[3 * c + 1] = distance[y + dy + 1 < ny ? n + nx : n] - distance[y + dy > 0 ? n - nx : n];
            slopes[3 * c + 2] = distance[z + dz + 1 < nz ? n + layer : n] - distance[z + dz > 0 ? n - layer : n];
        }
        let count = 0, px = 0, py = 0, pz = 0;
        for (let e = 0; e < 24; e += 2) {
            const a = kEdges[e], b = kEdges[e + 1], va = corner[a], vb = corner[b];
            if (va < 0 === vb < 0) continue;
            const t = va / (va - vb), bit = b - a;
            const cx = (a & 1) + (bit === 1 ? t : 0), cy = ((a >> 1) & 1) + (bit === 2 ? t : 0), cz = (a >> 2) + (bit === 4 ? t : 0);
            // The slope on the crossing's own side of an edge: that of the corner which lies nearer.
            let sx = 0, sy = 0, sz = 0;
            for (let k = 0; k < 2; ++k) {
                const w = k ? t : 1 - t, s = 3 * (k ? b : a);
                sx += w * slopes[s];
                sy += w * slopes[s + 1];
                sz += w * slopes[s + 2];
            }
            const length = Math.hypot(sx, sy, sz) || 1;
            crossings[3 * count] = cx;
            crossings[3 * count + 1] = cy;
            crossings[3 * count + 2] = cz;
            planes[3 * count] = sx / length;
            planes[3 * count + 1] = sy / length;
            planes[3 * count + 2] = sz / length;
            px += cx;
            py += cy;
            pz += cz;
            ++count;
        }
        px /= count;
        py /= count;
        pz /= count;
        let gx = 0, gy = 0, gz = 0;
        for (let i = 0; i < 3 * count; i += 3) {
            gx += planes[i];
            gy += planes[i + 1];
            gz += planes[i + 2];
        }
        // Towards all planes at once (after Schaefer's and Warren's particles), and not out of the cell.
        for (let move = 0; move < kMoves; ++move) {
            let fx = 0, fy = 0, fz = 0;
            for (let i = 0; i < 3 * count; i += 3) {
                const off = planes[i] * (crossings[i] - px) + planes[i + 1] * (crossings[i + 1] - py) + planes[i + 2] * (crossings[i + 2] - pz);
                fx += off * planes[i];
                fy += off * planes[i + 1];
                fz += off * planes[i + 2];
            }
            px += (kShare * fx) / count;
            py += (kShare * fy) / count;
            pz += (kShare * fz) / count;
        }
        const length = Math.hypot(gx, gy, gz) || 1;
        positions.push(x + Math.min(Math.max(px, 0), 1), y + Math.min(Math.max(py, 0), 1), z + Math.min(Math.max(pz, 0), 1));
        normals.push(gx / length, gy / length, gz / length);
    }

    // Around each edge of the grid that the surface crosses: the vertices of its four cells.
    for (let z = low[2]; z < high[2]; ++z)
        for (let y = low[1]; y < high[1]; ++y)
            for (let x = low[0]; x < high[0]; ++x) {
                const node = x + nx * y + layer * z, isIn = distance[node] < kMiddle;
                const v = x - low[0] + 1 + kSide * (y - low[1] + 1 + kSide * (z - low[2] + 1));
                for (let k = 0; k < 3; ++k) {
                    if (distance[node + step[k]] < kMiddle === isIn) continue;
                    const u = k === 0 ? kSide : k === 1 ? kSide * kSide : 1, w = k === 0 ? kSide * kSide : k === 1 ? 1 : kSide;
                    const a = vertexOf[v], b = vertexOf[v - u], c = vertexOf[v - u - w], d = vertexOf[v - w];
                    if (a < 0 || b < 0 || c < 0 || d < 0) continue; // at the grid's own end
                    if (isIn) triangles.push(a, b, c, a, c, d);
                    else triangles.push(a, c, b, a, d, c);
                }
            }
    return { positions: Float32Array.from(positions), normals: Float32Array.from(normals), triangles: Uint16Array.from(triangles) };
}

/**
 * All nodes of the chunk's cells lie on one side: most of a tooth is so.
 * @param {Uint8Array} distance @param {number} nx @param {number} layer @param {number[]} low @param {number[]} high
 */
function isEven(distance, nx, layer, low, high) {
    const [x0, y0, z0] = low.map((n) => Math.max(n - 1, 0)), isIn = distance[x0 + nx * y0 + layer * z0] < kMiddle;
    for (let z = z0; z <= high[2]; ++z)
        for (let y = y0; y <= high[1]; ++y)
            for (let n = x0 + nx * y + layer * z, end = n + high[0] - x0; n <= end; ++n) if (distance[n] < kMiddle !== isIn) return false;
    return true;
}

/**
 * Chunks that ask for a node of a brick.
 * @param {Iterable<number>} bricks @param {{nodes: [number, number, number], bricks: [number, number, number], brickEdge: number}} grid @returns {Set<number>} their numbers, x fastest
 */
export function chunksOf(bricks, grid) {
    const [cx, cy, cz] = chunkCounts(grid.nodes), [bx, by] = grid.bricks, edge = grid.brickEdge;
    /** @type {Set<number>} */
    const chunks = new Set();
    for (const brick of bricks) {
        const first = [(brick % bx) * edge, (Math.floor(brick / bx) % by) * edge, Math.floor(brick / (bx * by)) * edge];
        // A node is a corner of cells before it, its slope is asked one farther, and chunks share a layer of cells.
        const from = first.map((n) => Math.max(0, Math.floor((n - 2) / kChunk)));
        const to = first.map((n, k) => Math.min([cx, cy, cz][k] - 1, Math.floor((n + edge + 2) / kChunk)));
        for (let z = from[2]; z <= to[2]; ++z)
            for (let y = from[1]; y <= to[1]; ++y)
                for (let x = from[0]; x <= to[0]; ++x) chunks.add(x + cx * (y + cy * z));
    }
    return chunks;
}

/** @param {[number, number, number]} nodes @returns {[number, number, number]} */
export function chunkCounts(nodes) {
    return [Math.ceil((nodes[0] - 1) / kChunk), Math.ceil((nodes[1] - 1) / kChunk), Math.ceil((nodes[2] - 1) / kChunk)];
}
