// SPDX-License-Identifier: Apache-2.0
// A learning platform and a record store for the tests: keys of its own, checks what comes, tells what it has. Prints
// its port. Node alone, no packages.
import crypto from 'node:crypto';
import http from 'node:http';

const rsa = bits => crypto.generateKeyPairSync('rsa', { modulusLength: bits });
let key = rsa(2048), kid = 'k1';
const other = rsa(2048), small = rsa(1024);
let config = { failScores: 0, failStatements: 0, toolKeys: '', client: 'client-1', bearer: 'bearer-1', user: 'u', password: 'p' };
let scores = [], statements = new Map(), tokenRequests = 0;

const encoded = thing => Buffer.from(typeof thing === 'string' ? thing : JSON.stringify(thing)).toString('base64url');
const jwk = (pair, id) => ({ ...pair.publicKey.export({ format: 'jwk' }), kid: id, alg: 'RS256', use: 'sig' });
const pairs = { own: () => key, other: () => other, small: () => small };

function sign({ claims, header = {}, by = 'own', raw }) {
  const head = { alg: 'RS256', typ: 'JWT', kid, ...header };
  const text = encoded(head) + '.' + (raw ?? encoded(claims));
  if (head.alg === 'none') return text + '.';
  if (head.alg === 'HS256')
    return text + '.' + crypto.createHmac('sha256', key.publicKey.export({ type: 'spki', format: 'pem' })).update(text).digest('base64url');
  return text + '.' + crypto.sign('sha256', Buffer.from(text), pairs[by]().privateKey).toString('base64url');
}

async function token(body, own) {
  ++tokenRequests;
  const form = new URLSearchParams(body);
  const said = form.get('client_assertion') ?? '';
  const [head, claims, signature] = said.split('.');
  const { keys } = await (await fetch(config.toolKeys)).json();
  const header = JSON.parse(Buffer.from(head, 'base64url')), c = JSON.parse(Buffer.from(claims, 'base64url'));
  const found = keys.find(one => one.kid === header.kid);
  const isSigned = found && crypto.verify('sha256', Buffer.from(head + '.' + claims), crypto.createPublicKey({ key: found, format: 'jwk' }), Buffer.from(signature, 'base64url'));
  const isWell = isSigned && form.get('grant_type') === 'client_credentials' && c.iss === config.client && c.sub === config.client &&
    form.get('client_assertion_type') === 'urn:ietf:params:oauth:client-assertion-type:jwt-bearer' &&
    c.aud === own + '/token' && c.exp > Date.now() / 1000 && c.jti && form.get('scope') === 'https://purl.imsglobal.org/spec/lti-ags/scope/score';
  return isWell ? [200, { access_token: config.bearer, token_type: 'bearer', expires_in: 3600 }] : [401, { error: 'invalid_client' }];
}

function takeScore(request, body) {
  if (request.headers.authorization !== 'Bearer ' + config.bearer) return [401, {}];
  if (request.headers['content-type'] !== 'application/vnd.ims.lis.v1.score+json') return [415, {}];
  if (config.failScores > 0) return --config.failScores, [503, {}];
  const score = JSON.parse(body);
  if (!score.userId || !score.activityProgress || !score.gradingProgress || isNaN(Date.parse(score.timestamp))) return [400, {}];
  scores.push({ ...score, address: request.url });
  return [200, {}];
}

function takeStatements(request, body) {
  if (request.headers['x-experience-api-version'] !== '1.0.3') return [400, { error: 'version' }];
  if (request.headers.authorization !== 'Basic ' + Buffer.from(config.user + ':' + config.password).toString('base64')) return [401, {}];
  if (config.failStatements > 0) return --config.failStatements, [503, {}];
  const list = JSON.parse(body);
  if (list.some(one => statements.has(one.id))) return [409, { error: 'there is one of this id' }];
  for (const one of list) statements.set(one.id, one);
  return [200, list.map(one => one.id)];
}

const server = http.createServer(async (request, response) => {
  let body = '';
  for await (const piece of request) body += piece;
  const path = request.url.split('?')[0], own = 'http://127.0.0.1:' + server.address().port;
  const answer = (status, thing) => {
    response.writeHead(status, { 'Content-Type': 'application/json' });
    response.end(typeof thing === 'string' ? thing : JSON.stringify(thing));
  };
  try {
    if (path === '/jwks') return answer(200, { keys: [jwk(key, kid), jwk(small, 'small')] });
    if (path === '/sign') return answer(200, sign(JSON.parse(body)));
    if (path === '/rotate') return (key = rsa(2048)), (kid += '1'), answer(200, {});
    if (path === '/config') return (config = { ...config, ...JSON.parse(body) }), answer(200, {});
    if (path === '/token') return answer(...(await token(body, own)));
    if (path === '/lineitems/1/scores' && request.method === 'POST') return answer(...takeScore(request, body));
    if (path === '/xapi/statements' && request.method === 'POST') return answer(...takeStatements(request, body));
    if (path === '/told') return answer(200, { scores, statements: [...statements.values()], tokenRequests });
    if (path === '/end') return answer(200, {}), setTimeout(() => process.exit(0), 50);
    answer(404, {});
  } catch (error) {
    answer(400, { error: String(error) });
  }
});
server.listen(0, '127.0.0.1', () => console.log(server.address().port));
