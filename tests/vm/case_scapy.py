# SPDX-License-Identifier: GPL-3.0-or-later
"""Uses scapy's UDS layer as a tester."""
import subprocess
import sys

import bench
from bench import DESIGN, controllers, triskin

SESSION = r"""
from scapy.config import conf
conf.contribs['ISOTP'] = {'use-can-isotp-kernel-module': False}
conf.contribs['CANSocket'] = {'use-python-can': True}
conf.contribs['CAN'] = {'swap-bytes': False, 'remove-padding': True}
conf.contribs['UDS'] = {'treat-response-pending-as-answer': False}
from scapy.all import load_contrib
for name in ('cansocket', 'isotp', 'automotive.uds'):
    load_contrib(name)
socket = ISOTPSoftSocket(CANSocket(bustype='socketcan', channel='vcan1'), tx_id=0x18DA01F1, rx_id=0x18DAF101, basecls=UDS, padding=True)
def ask(request):
    answer = socket.sr1(request, timeout=5, verbose=False)
    return bytes(answer).hex() if answer is not None else 'none'
print('part', ask(UDS() / UDS_RDBI(identifiers=[0xF190])))
print('serial', ask(UDS() / UDS_RDBI(identifiers=[0xF18C])))
print('session', ask(UDS() / UDS_DSC(diagnosticSessionType=3)))
print('write', ask(UDS() / UDS_WDBI(dataIdentifier=0xFD05) / b'\x01'))
print('present', ask(UDS() / UDS_TP(subFunction=0)))
socket.close()
"""


def test_scapy_reads_identifiers_and_is_refused_a_write():
    with controllers("can:vcan1"):
        serial = triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")["patches"][0]["serial"]
        done = subprocess.run([sys.executable, "-c", SESSION], capture_output=True, text=True, timeout=180, stdin=subprocess.DEVNULL)
        bench.log.append(done.stdout + done.stderr[-3000:])
    answers = dict(line.split() for line in done.stdout.splitlines())
    assert answers["part"] == "62f190" + b"TRISKIN1".hex(), answers
    assert answers["serial"] == "62f18c" + serial.replace("-", "").lower(), (answers, serial)
    assert answers["session"] == "5003003201f4", answers
    assert answers["write"] == "7f2e33", answers
    assert answers["present"] == "7e00", answers
