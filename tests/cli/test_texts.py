#!/usr/bin/env python3
"""test_texts.py BUILD - names of files in all that programs read: JSON, XML, SVG and reports, by Python's own readers. Hostile names are
quotes, marks, controls, UTF-8 of each length, and bytes that are none. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
import zipfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, verdict  # noqa: E402

build = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "build")
program = os.path.join(build, "contactplant")
directory = tempfile.mkdtemp()
SCENE = """[plant]
model = hertz_rig
[drive force]
amplitude = 1 N
frequency = 225 Hz
[ask]
observable = penetration
over = 0.1 s
tolerance = 0.05
"""
TEST = """[plant]
scene = hertz_rig
[controller]
builtin = keep
[case "it's" <&> \\ ]]>]
over = 0.1 s
expect penetration >= 1 m
"""
here = "127.%d.%d.1:20000" % (os.getpid() >> 8 & 127, os.getpid() & 255)
every_byte = bytes(b for b in range(1, 256) if b != ord("/"))
NAMES = [b"plain", "pr\u00fcfung \u65e5\u672c \U0001f600".encode(), b"q\"'`\\", b"<a>&]]>--", b"a,b;c", b"line\nand\ttab\r", b"pr\xfcf", b"cut\xe2\x82",
         b"\xf0\x9f\x98.\xed\xa0\x80.\xc0\xaf.\xf4\x90\x80\x80", every_byte[:127], every_byte[127:], "x\u00fc".encode() + "\u00fc".encode() * 90]


def run(*arguments):
    return subprocess.run([program, *arguments], cwd=directory, capture_output=True, timeout=300)


def read(name):
    with open(os.path.join(directory, name), "rb") as f:
        return f.read()


def text_of(name):
    return name.decode("utf-8", "replace")


def first(name, size):
    """Whole characters among the first bytes."""
    while len(name) > size and name[size] & 0xC0 == 0x80:
        size -= 1
    return name[:size]


def xml_text_of(name):
    return re.sub("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]", "\ufffd", text_of(name))


def data_of(page):
    """The JSON in a report."""
    return json.loads(page.decode("utf-8").split('id="data">\n', 1)[1].split("</script>", 1)[0])


def title_of(svg):
    return xml.fromstring(svg).find("{http://www.w3.org/2000/svg}title").text


def same(what, got, wanted):
    verdict("%s: %.60r" % (what, wanted), got == wanted, repr(got))


def programs_of_a_scene(name):
    scene = name + b".ini"
    with open(os.path.join(directory.encode(), scene), "w") as f:
        f.write(SCENE)
    run("choose", scene, "--json", "o.json", "--report", "o.html", "--out", "o.ini")
    same("choose --json", json.loads(read("o.json"))["scene"], text_of(scene))
    same("choose --report", data_of(read("o.html"))["title"], "choose " + text_of(scene))
    again = run("scene", "o.ini")
    verdict("choose --out is a scene", again.returncode == 0, again.stderr)
    run("simulate", scene, "--report", "o.html", "--out", "o.csv")
    same("simulate --report", data_of(read("o.html"))["title"], "simulate " + text_of(scene))
    run("sweep", scene, "--sweep", "force.frequency=220:230:3", "--svg", "o.svg", "--report", "o.html", "--out", "s.csv")
    same("sweep --svg, as far as there is room", title_of(read("o.svg")), "contactplant sweep " + xml_text_of(first(scene, 100)))
    same("sweep --report", data_of(read("o.html"))["title"], "sweep " + text_of(scene))
    os.remove(os.path.join(directory, "s.csv"))
    run("fmu", scene, "--out", "o.fmu")
    with zipfile.ZipFile(os.path.join(directory, "o.fmu")) as z:
        same("fmu", xml.fromstring(z.read("modelDescription.xml")).get("modelName"), xml_text_of(scene))
    log = name + b".log"
    run("run", scene, "--bus", "udp:" + here, "--duration", "0.05", "--json", "o.json", "--report", "o.html", "--log", log)
    verdict("run --json", json.loads(read("o.json"))["model"] == "hertz_rig")
    same("run --report", data_of(read("o.html"))["title"], "run " + text_of(scene))
    run("decode", log, scene, "--svg", "o.svg", "--report", "o.html", "--out", "o.csv")
    same("decode --svg, as far as there is room", title_of(read("o.svg")), "contactplant decode " + xml_text_of(first(log, 100)))
    same("decode --report", data_of(read("o.html"))["title"], "decode " + text_of(log))
    wrong = run("simulate", scene + b".none")
    told = wrong.stderr.decode("utf-8", "surrogateescape")
    verdict("a message is one line of UTF-8", len(told.splitlines()) == 1 and told.endswith("\n") and not re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f\ud800-\udfff]", told), wrong.stderr)


def programs_of_a_test(name):
    test = name + b".test"
    with open(os.path.join(directory.encode(), test), "w") as f:
        f.write(TEST)
    r = run("test", test, "--json", "o.json", "--junit", "o.xml", "--report", "o.html", "--log", ".")
    case = json.loads(read("o.json"))["cases"][0]
    same("test --json", case["file"], text_of(test))
    same("test --json, case", case["case"], "\"it's\" <&> \\ ]]>")
    suite = xml.fromstring(read("o.xml"))
    found = next(suite.iter("testcase"))
    verdict("test --junit: %.60r" % xml_text_of(test), xml_text_of(test) in (found.get("classname"), found.get("file")), found.attrib)
    same("test --junit, case", found.get("name"), "\"it's\" <&> \\ ]]>")
    message = next(found.iter("failure")).get("message")
    verdict("test --junit, message", ":7: expect penetration >= 1 m: it" in message, message)
    data_of(read("o.html"))


def hello_of(scene):
    """What a browser hears first of a scope of this scene."""
    child = subprocess.Popen([program, "scope", scene, "--bus", "udp:" + here, "--http", here], cwd=directory, stderr=subprocess.PIPE)
    child.stderr.readline()
    address, port = here.split(":")
    heard = more = b"-"
    with socket.create_connection((address, int(port)), timeout=60) as s:
        s.sendall(b"GET /events HTTP/1.1\r\nHost: localhost:%s\r\n\r\n" % port.encode())
        while more and not re.search(b"event: hello\ndata: .*\n\n", heard):
            more = s.recv(1 << 16)
            heard += more
    child.kill()
    child.communicate()
    return json.loads(heard.split(b"event: hello\ndata: ", 1)[1].split(b"\n", 1)[0].decode("utf-8"))


def scope(name):
    scene = (name * 200)[:200] + b".ini"
    with open(os.path.join(directory.encode(), scene), "w") as f:
        f.write(SCENE)
    same("scope", hello_of(scene)["plants"][0]["name"], text_of(scene))


for hostile in NAMES[1], NAMES[2], NAMES[8]:
    scope(hostile)
for hostile in NAMES:
    programs_of_a_scene(hostile)
    programs_of_a_test(hostile)
conclude()
