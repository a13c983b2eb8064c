// A drone on Node's gRPC library: the acts `connect`, `call`, `calls` and `subscribe` of drone.py, line by line.
// Its argument is the folder of the contract. NODE_PATH leads to @grpc/grpc-js and @grpc/proto-loader.
'use strict';

const fs = require('fs');
const readline = require('readline');
const grpc = require('@grpc/grpc-js');
const loader = require('@grpc/proto-loader');

// A wait that does not end is the test's failure, not its end.
const PATIENCE_SECONDS = 30;
const FORM = {keepCase: true, longs: String, enums: String, defaults: true, includeDirs: [process.argv[2]]};
const {uncrew} = grpc.loadPackageDefinition(loader.loadSync('uncrew/v1/avatar.proto', FORM));
const clients = {};

const without = (prefix, text) => text.startsWith(prefix) ? text.slice(prefix.length) : text;
const reasonOf = (text) => without('REJECT_REASON_', text);

function answerOf(response) {
  const dropped = Object.fromEntries(response.dropped.map((each) => [each.field, reasonOf(each.reason)]));
  const reason = reasonOf(response.reason);
  return {
    outcome: without('OUTCOME_', response.outcome), field: response.field, detail: response.detail, dropped,
    ...(reason === 'UNSPECIFIED' ? {} : {reason}),
  };
}

const ended = (error) => ({code: grpc.status[error ? error.code : 0], details: error ? error.details : ''});

const acts = {
  connect({name, target, ca, certificate, key}) {
    const read = (path) => path ? fs.readFileSync(path) : null;
    const credentials = grpc.credentials.createSsl(read(ca), read(key), read(certificate));
    clients[name] = new uncrew.v1.AvatarService(target, credentials, {'grpc.ssl_target_name_override': 'localhost'});
    return {};
  },

  call({to, type, request, deadline = PATIENCE_SECONDS, lose_after: loseAfter}) {
    return new Promise((resolve) => {
      const options = {deadline: Date.now() + 1000 * deadline};
      const call = clients[to]['Publish' + type](request, options, (error, response) => {
        resolve({...ended(error), ...(error ? {} : answerOf(response))});
      });
      if (loseAfter !== undefined) setTimeout(() => call.cancel(), 1000 * loseAfter);
    });
  },

  calls({calls}) {
    return Promise.all(calls.map(acts.call));
  },

  async subscribe({to, times}) {
    const ends = {commands: 0};
    for (let i = 0; i < times; ++i) {
      const error = await new Promise((resolve) => {
        const call = clients[to].SubscribeUAVCommands({});
        call.on('data', () => ++ends.commands);
        call.on('error', resolve);
        call.on('end', () => resolve(null));
      });
      const {code, details} = ended(error);
      ends[`${code}: ${details}`] = (ends[`${code}: ${details}`] || 0) + 1;
    }
    return ends;
  },
};

async function main() {
  for await (const line of readline.createInterface({input: process.stdin})) {
    const {act, ...command} = JSON.parse(line);
    process.stdout.write(JSON.stringify(await acts[act](command)) + '\n');
  }
}

main();
