# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the skin beside another task of asyncio. Usage: async_tasks.py DESIGN"""
import asyncio
import sys

import triskin


async def watch(skin, seconds):
    samples = 0
    async for block in skin.blocks_async(0.2):
        samples += len(block)
        seconds -= 0.2
        if seconds <= 0.0:
            return samples


async def control(steps):
    for _ in range(steps):
        await asyncio.sleep(0.001)  # a controller would do its work here
    return steps


async def main():
    with triskin.simulate(sys.argv[1]) as skin:
        samples, steps = await asyncio.gather(watch(skin, 2.0), control(50))
    print(f"{samples} samples while another task took {steps} steps")


asyncio.run(main())
