// SPDX-License-Identifier: GPL-3.0-or-later
// Prints what a Gerber file draws, in its unit, as tracespace reads it. usage: node gerber_shapes.mjs NODE_MODULES FILE
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';

const require = createRequire(`${process.argv[2]}/`);
const {parse} = require('@tracespace/parser');
const {plot} = require('@tracespace/plotter');
process.stdout.write(JSON.stringify(plot(parse(readFileSync(process.argv[3], 'utf8')))));
