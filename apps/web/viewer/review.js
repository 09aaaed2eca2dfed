// SPDX-License-Identifier: Apache-2.0
/**
 * What a review is made of, and the tooth at any time of it. No page and no drawing here: docs/review.md.
 * @module
 */

/**
 * @typedef {[number, number, number]} Vec3
 * @typedef {{fromS: number, name: string, outlineMm: [number, number][]}} Bur outline as radius and height over the tip
 * @typedef {{timeS: number, text: string}} Moment
 * @typedef {{title: string, lost: string, measured: string, practise: string, placeMm?: Vec3, timeS?: number}} LostPoints
 * @typedef {{id: number, name: string, colour: string}} Tissue
 * @typedef {object} ReviewText as the page holds it
 * @property {string} format
 * @property {number} version
 * @property {string} language
 * @property {string} title
 * @property {Record<string, string>} words
 * @property {number} durationS
 * @property {number} buccalSign
 * @property {boolean} [isUpper]
 * @property {string[]} notes what is not as it was
 * @property {{originMm: Vec3, voxelMm: number, nodes: Vec3, bricks: Vec3, brickEdge: number, stepsAVoxel: number}} grid
 * @property {Tissue[]} tissues
 * @property {{lowMm: Vec3, stepMm: number, parts: {name: string, colour: string, vertices: number, triangles: number}[]}} around adjacent teeth and gingiva, as they were before
 * @property {Bur[]} burs
 * @property {[number, number][]} strokes
 * @property {Moment[]} moments
 * @property {LostPoints[]} [errors]
 * @property {{mostMm: number, scale: string[], whole: number[]}} [deviation] whole: by distance to the uncut tooth, that to the ideal where nothing is to be cut
 * @property {{timesS: number[], bricks: number[]}} keys
 * @property {number} poses
 * @property {number} curvePoints
 * @property {{name: string, bytes: number}[]} sections
 */

/** @typedef {{placeMm: Vec3, turn: [number, number, number, number], tipDepthMm: number}} Pose turn: w x y z */

const kVersion = 2;
/** Steps of the numbers of 16 bits. */
const kPlaceStepMm = 0.002, kTurnStep = 1 / 32767, kForceStepN = 0.001, kDepthStepMm = 0.001;
/** A distance of zero; more is outside. */
export const kMiddle = 128;

/** @param {Uint8Array} bytes a zlib stream @returns {Promise<Uint8Array>} */
async function inflated(bytes) {
    // Not known to the compiler's library of this age.
    const Inflate = /** @type {any} */ (globalThis).DecompressionStream;
    if (!Inflate) throw new Error("this browser cannot unpack the recording");
    const stream = new Blob([bytes]).stream().pipeThrough(new Inflate("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** @param {string} text base64 @returns {Uint8Array} */
export function bytesOf(text) {
    const binary = atob(text.trim());
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
    return bytes;
}

/**
 * In place.
 * @param {Uint8Array} values differences to what stands before along all axes @param {Vec3} nodes
 */
function sumUp(values, [nx, ny, nz]) {
    const layer = nx * ny;
    for (let z = 0, i = 0; z < nz; ++z)
        for (let y = 0; y < ny; ++y)
            for (let x = 0; x < nx; ++x, ++i) {
                let v = values[i];
                if (x) v += values[i - 1];
                if (y) v += values[i - nx];
                if (z) v += values[i - layer];
                if (x && y) v -= values[i - 1 - nx];
                if (x && z) v -= values[i - 1 - layer];
                if (y && z) v -= values[i - nx - layer];
                if (x && y && z) v += values[i - 1 - nx - layer];
                values[i] = v & 255;
            }
    return values;
}

/** @param {Uint8Array} bytes low bytes of a row, then its high ones @param {number} count @param {number} rows */
function rowsOf(bytes, count, rows) {
    const all = [];
    for (let r = 0; r < rows; ++r) {
        const row = new Int16Array(count), low = 2 * r * count, high = low + count;
        for (let i = 0, sum = 0; i < count; ++i) {
            sum = (sum + bytes[low + i] + 256 * bytes[high + i]) & 65535;
            row[i] = sum;
        }
        all.push(row);
    }
    return all;
}

/**
 * What stands around the tooth, each part with the normals of its vertices.
 * @param {ReviewText} text @param {Uint8Array} bytes
 */
function aroundOf(text, bytes) {
    const { lowMm, stepMm, parts } = text.around;
    let at = 0;
    /** @param {number} count */
    const threes = (count) => {
        const rows = rowsOf(bytes.subarray(at, at + 6 * count), count, 3);
        at += 6 * count;
        return rows;
    };
    return parts.map((part) => {
        const [x, y, z] = threes(part.vertices), corners = threes(part.triangles);
        const places = new Float32Array(3 * part.vertices), normals = new Float32Array(3 * part.vertices), triangles = new Uint16Array(3 * part.triangles);
        for (let i = 0; i < part.vertices; ++i) places.set([x, y, z].map((row, k) => lowMm[k] + stepMm * (row[i] & 65535)), 3 * i);
        for (let i = 0; i < part.triangles; ++i) {
            const [a, b, c] = corners.map((row) => row[i] & 65535);
            triangles.set([a, b, c], 3 * i);
            const u = [0, 1, 2].map((k) => places[3 * b + k] - places[3 * a + k]), v = [0, 1, 2].map((k) => places[3 * c + k] - places[3 * a + k]);
            for (let k = 0; k < 3; ++k) {
                const n = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
                for (const corner of [a, b, c]) normals[3 * corner + k] += n;
            }
        }
        return { colour: part.colour, places, normals, triangles };
    });
}

/**
 * The last index whose time is not after `timeS`; 0 before all.
 * @param {ArrayLike<number>} times @param {number} timeS
 */
export function indexAt(times, timeS) {
    let low = 0, high = times.length;
    while (low < high) {
        const middle = (low + high) >> 1;
        if (times[middle] <= timeS) low = middle + 1;
        else high = middle;
    }
    return Math.max(0, low - 1);
}

/** All of a recording. Nothing in it changes. */
export class Review {
    /** @param {ReviewText} text @param {Uint8Array} all unpacked */
    constructor(text, all) {
        if (text.format !== "handpiece-review" || text.version !== kVersion)
            throw new Error(`this is no review of version ${kVersion}`);
        this.text = text;
        /** @type {Record<string, Uint8Array>} */
        const sections = {};
        let at = 0;
        for (const { name, bytes } of text.sections) {
            sections[name] = all.subarray(at, at + bytes);
            at += bytes;
        }
        if (at !== all.length) throw new Error("the recording in this page is cut short");
        const nodes = text.grid.nodes;
        /** Distances before any cut, a byte a node, x fastest. */
        this.uncut = sumUp(sections.uncut, nodes);
        this.tissue = sections.tissue;
        for (let i = 1; i < this.tissue.length; ++i) this.tissue[i] = (this.tissue[i] + this.tissue[i - 1]) & 255;
        /** To the ideal tooth; null without an exercise. */
        this.ideal = text.deviation ? sumUp(sections.ideal, nodes) : null;
        if (this.ideal && text.deviation)
            for (let i = 0; i < this.ideal.length; ++i) this.ideal[i] = (this.ideal[i] + text.deviation.whole[this.uncut[i]]) & 255;
        this.around = aroundOf(text, sections.around);
        this.changes = sections.changes;
        this.bricks = new Uint32Array(sections.bricks.length / 3);
        /** By key: its first brick. */
        this.firstBrick = new Uint32Array(text.keys.bricks.length + 1);
        for (let k = 0, i = 0; k < text.keys.bricks.length; ++k) {
            for (let n = 0, brick = 0; n < text.keys.bricks[k]; ++n, ++i) {
                brick += sections.bricks[3 * i] + 256 * sections.bricks[3 * i + 1] + 65536 * sections.bricks[3 * i + 2];
                this.bricks[i] = brick;
            }
            this.firstBrick[k + 1] = this.firstBrick[k] + text.keys.bricks[k];
        }
        const rows = rowsOf(sections.poses, text.poses, 9);
        this.poseTimesS = new Float64Array(text.poses);
        for (let i = 0, ms = 0; i < text.poses; ++i) {
            ms += rows[0][i] & 65535;
            this.poseTimesS[i] = ms / 1000;
        }
        this.poses = rows;
        const curves = rowsOf(sections.curves, text.curvePoints, 2);
        this.curveTimesS = Float64Array.from(curves[0], (t) => ((t & 65535) / 65535) * text.durationS);
        this.forceN = Float64Array.from(curves[1], (f) => f * kForceStepN);
        this.tipDepthMm = Float64Array.from(rows[8], (d) => d * kDepthStepMm);
    }

    /** @param {number} i pose @returns {Vec3} */
    placeOf(i) {
        const p = this.poses;
        return [p[1][i] * kPlaceStepMm, p[2][i] * kPlaceStepMm, p[3][i] * kPlaceStepMm];
    }
    /** @param {number} i pose @returns {[number, number, number, number]} */
    turnOf(i) {
        const p = this.poses;
        return [p[4][i] * kTurnStep, p[5][i] * kTurnStep, p[6][i] * kTurnStep, p[7][i] * kTurnStep];
    }
    /** @param {number} timeS @returns {Pose} */
    poseAt(timeS) {
        const i = indexAt(this.poseTimesS, timeS);
        return { placeMm: this.placeOf(i), turn: this.turnOf(i), tipDepthMm: this.tipDepthMm[i] };
    }
    /**
     * The one at which the bur's tip lay nearest to a place.
     * @param {Vec3} placeMm
     */
    nearestPose(placeMm) {
        let nearest = 0, least = Infinity;
        for (let i = 0; i < this.text.poses; ++i) {
            const [x, y, z] = this.placeOf(i), square = (x - placeMm[0]) ** 2 + (y - placeMm[1]) ** 2 + (z - placeMm[2]) ** 2;
            if (square < least) [nearest, least] = [i, square];
        }
        return nearest;
    }
    /** @param {number} timeS */
    forceAt(timeS) {
        return this.forceN.length ? this.forceN[indexAt(this.curveTimesS, timeS)] : 0;
    }
    /** @param {number} timeS */
    burAt(timeS) {
        const burs = this.text.burs;
        return burs[indexAt(burs.map((bur) => bur.fromS), timeS)];
    }
}

/** @param {ReviewText} text @param {Uint8Array} packed @returns {Promise<Review>} */
export async function unpackReview(text, packed) {
    return new Review(text, await inflated(packed));
}

/** The tooth as it was at a time: the one thing of a review that changes. */
export class ToothAtTime {
    /** @param {Review} review */
    constructor(review) {
        this.review = review;
        /** Distances now. */
        this.distance = review.uncut.slice();
        /** Keys that are in it. */
        this.keys = 0;
    }

    /** @param {number} timeS @returns {Set<number>} bricks that are others now */
    seek(timeS) {
        const { review } = this, times = review.text.keys.timesS;
        const wanted = times.length && times[0] <= timeS ? indexAt(times, timeS) + 1 : 0;
        /** @type {Set<number>} */
        const touched = new Set();
        for (; this.keys < wanted; ++this.keys) this.apply_(this.keys, 1, touched);
        while (this.keys > wanted) this.apply_(--this.keys, -1, touched);
        return touched;
    }

    /** @param {number} key @param {1 | -1} sign @param {Set<number>} touched */
    apply_(key, sign, touched) {
        const { bricks, changes, firstBrick, text } = this.review;
        const { nodes: [nx, ny], bricks: [bx, by], brickEdge: edge } = text.grid;
        const now = this.distance, perBrick = edge ** 3;
        for (let i = firstBrick[key]; i < firstBrick[key + 1]; ++i) {
            const brick = bricks[i];
            touched.add(brick);
            const x0 = (brick % bx) * edge, y0 = (Math.floor(brick / bx) % by) * edge, z0 = Math.floor(brick / (bx * by)) * edge;
            let from = i * perBrick;
            for (let z = 0; z < edge; ++z)
                for (let y = 0; y < edge; ++y) {
                    const row = x0 + nx * (y0 + y + ny * (z0 + z));
                    for (let x = 0; x < edge; ++x) now[row + x] += sign * changes[from++];
                }
        }
    }
}
