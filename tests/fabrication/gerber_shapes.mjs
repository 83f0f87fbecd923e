// SPDX-License-Identifier: GPL-3.0-or-later
// Prints what a Gerber file draws, in mm, as read by tracespace: usage: node gerber_shapes.mjs FILE
import {readFileSync} from 'node:fs';
import {parse} from '@tracespace/parser';
import {plot} from '@tracespace/plotter';

const image = plot(parse(readFileSync(process.argv[2], 'utf8')));
process.stdout.write(JSON.stringify(image));
