"""Recordings as tools write them, read by meissner.readers: what was taken for what, by hand, and the one
sentence for each file that is none. The files are literal text or made by another library, never by this
package."""

import io
import struct
import sys
import zipfile

import numpy as np
import pytest
import scipy.io

import meissner
from meissner import calibration, engines, host, readers
from meissner.host import line, log
from meissner.host.simulated import SimulatedCore
from meissner.physics.adc import Adc
from meissner.twins.link import packet

EVEN = {  # name: (text, names, unit, samples per second, values by column)
    "saleae.csv": (
        "Time [s],Channel 0,Channel 1\n0.000000000,1.25,-0.5\n0.000100000,1.5,0.25\n0.000200000,1.75,0.125\n",
        ("Channel 0", "Channel 1"), "", 1e4, [[1.25, 1.5, 1.75], [-0.5, 0.25, 0.125]],
    ),
    "waveforms.csv": (
        "#Digilent WaveForms Oscilloscope Acquisition\n#Device Name: Discovery2\n#Serial Number: SN:210321\n"
        "#Date Time: 2024-03-05 10:11:12.131.415.926\n#Sample rate: 8e+06Hz\n#Samples: 3\n"
        "#Trigger: Source: Channel 1 Type: Edge Condition: Rise Level: 1 V\n"
        "#Channel 1: Range: 500 mV/div Offset: -1 V\n\n"
        "Time (s),Channel 1 (V),Channel 2 (V)\n-0.0005,2.5,1\n-0.0004,2.25,2\n-0.0003,2.125,4\n",
        ("Channel 1", "Channel 2"), "V", 1e4, [[2.5, 2.25, 2.125], [1, 2, 4]],
    ),
    "pico.csv": (
        "Time,Channel A,Channel B\n(ms),(mV),(V)\n\n-0.50000000,1500.0,0.25\n-0.25000000,1250.0,0.5\n"
        "0.00000000,-125.0,0.75\n",
        ("Channel A", "Channel B"), "V", 4000, [[1.5, 1.25, -0.125], [0.25, 0.5, 0.75]],
    ),
    "pico_de.csv": (
        "Zeit;Kanal A\n(µs);(V)\n\n0,00000;-1,25\n50,00000;1,5E-3\n100,00000;,75\n",
        ("Kanal A",), "V", 20e3, [[-1.25, 0.0015, 0.75]],
    ),
    "labjack.dat": (
        "Time\tAIN0\tAIN1\n0.0000\t2.5\t0.1\n0.0020\t2.25\t0.2\n0.0040\t2.125\t0.3\n",
        ("AIN0", "AIN1"), "", 500, [[2.5, 2.25, 2.125], [0.1, 0.2, 0.3]],
    ),
    "index.csv": (
        ",time_ms,left,right\n0,0.0,7,1\n1,2.5,8,2\n2,5.0,6,4\n",
        ("left", "right"), "", 400, [[7, 8, 6], [1, 2, 4]],
    ),
    "sample.csv": ("Sample,ADC\r\n5,512\r\n6,513\r\n7,511\r\n", ("ADC",), "codes", None, [[512, 513, 511]]),
    "arduino.txt": ("512\n513\n511\n", ("column 1",), "", None, [[512, 513, 511]]),
    "two.txt": ("512\t7\n513\t8\n511\t6\n", ("column 1", "column 2"), "", None, [[512, 513, 511], [7, 8, 6]]),
    "plotter.log": (
        "Light:512,Heat:-23.5\nLight:513,Heat:22\nLight:511,Heat:21\n",
        ("Light", "Heat"), "", None, [[512, 513, 511], [-23.5, 22, 21]],
    ),
    "spaces.log": ("a: 1 b: 2\na: 3 b: 5\n", ("a", "b"), "", None, [[1, 3], [2, 5]]),
    "monitor.txt": (
        "23:59:59.990 -> 512\n00:00:00.000 -> 513\n00:00:00.010 -> 511\n",
        ("column 1",), "", 100, [[512, 513, 511]],
    ),
    "micros.csv": ("micros,Vc\n1000,5\n1100,6\n1200,8\n", ("Vc",), "", 1e4, [[5, 6, 8]]),
    "seconds.csv": ("Time,x\n0.5,5\n0.75,6\n1.0,8\n", ("x",), "", 4, [[5, 6, 8]]),
    "numpy.csv": ("# t (s),a,b\n0.0,1,2\n0.5,3,5\n", ("a", "b"), "", 2, [[1, 3], [2, 5]]),
    "comment.csv": ("% Sample rate: 2.5 kHz\n// 2\na;b\n1;2\n3;5\n", ("a", "b"), "", 2500, [[1, 3], [2, 5]]),
    "quoted.csv": (
        '"Time (s)","Channel A, filtered (V)"\n"0.0","1.5"\n"0.5","2.5"\n',
        ("Channel A, filtered",), "V", 2, [[1.5, 2.5]],
    ),
    "quoted_comma.csv": (
        '"t (s)","a (V)","hand"\n"0,0","1,5","left, old"\n"0,5","2,5","left"\n',
        ("a",), "V", 2, [[1.5, 2.5]],
    ),
    "trailing.csv": ("Time [ms],a [V],\n0,1.5,\n2,2.5,\n", ("a",), "V", 500, [[1.5, 2.5]]),
    "alike.csv": ("t_us,v,v\n0,1,2\n8,3,5\n", ("v", "v 2"), "", 125e3, [[1, 3], [2, 5]]),
    "rising.csv": ("0,0.00,3\n1,0.02,1\n2,0.04,4\n3,0.06,1\n", ("column 3",), "", None, [[3, 1, 4, 1]]),
    "ramp.txt": ("0\n1\n2\n3\n4\n", ("column 1",), "", None, [[0, 1, 2, 3, 4]]),
    "numbers.csv": ("t (s),1,2\n0.0,3,5\n0.5,4,6\n", ("1", "2"), "", 2, [[3, 4], [5, 6]]),
    "text.csv": (
        "when;Vc;finger\n01.02.2024 10:00:00;1,5;left\n01.02.2024 10:00:01;2,5;left\n",
        ("Vc",), "", None, [[1.5, 2.5]],
    ),
    "stamped.log": (
        "10:00:00.000 -> a:1\tb:2\n10:00:00.020 -> a:3\tb:5\n", ("a", "b"), "", 50, [[1, 3], [2, 5]],
    ),
    "millis.csv": (  # 800 Hz, the times cut to milliseconds
        "ms,x\n" + "".join(f"{int(1.25 * k)},{k % 3}\n" for k in range(200)),
        ("x",), "", 800, [[k % 3 for k in range(200)]],
    ),
    # Spaces between the columns, and decimal commas; a unit behind a stroke, as DIN 1313 writes it.
    "spaces_de.txt": (
        "t/ms U/V W/V\n0,0 1,5 3\n0,5 2,5 2,25\n1,0 ,5 1e-1\n",
        ("U", "W"), "V", 2000, [[1.5, 2.5, 0.5], [3, 2.25, 0.1]],
    ),
    "spaces_only.txt": ("1,5 2\n2,5 3,75\n", ("column 1", "column 2"), "", None, [[1.5, 2.5], [2, 3.75]]),
    "excel.csv": (
        "sep=;\r\n7;1,5\r\n5;2,5\r\n;\r\n;\r\n",
        ("column 1", "column 2"), "", None, [[7, 5], [1.5, 2.5]],
    ),
    "pandas.csv": (",0,1\n0,12,13\n1,11,14\n", ("0", "1"), "", None, [[12, 11], [13, 14]]),
    "keysight.csv": (
        "x-axis,1\nsecond,Volt\n-1E-3,+2.5E-01\n0.0E+0,-5.0E-01\n", ("1",), "V", 1000, [[0.25, -0.5]],
    ),
    "head.csv": ("t (s),a,\n0.0,1\n0.5,3\n", ("a",), "", 2, [[1, 3]]),
    "dates.csv": ("date;a;b\n01.02.24;5;1,5\n01.02.24;6;2,5\n", ("a", "b"), "", None, [[5, 6], [1.5, 2.5]]),
    "long.csv": (  # in a moment, too
        f"# {'sampl' * 40_000}\na{' ' * 90_000}b,c\n1,2\n3,5\n",
        (f"a{' ' * 90_000}b", "c"), "", None, [[1, 3], [2, 5]],
    ),
    "dated.csv": ("when,a\nFri Mar 1 10:00:00,5\nFri Mar 1 10:00:01,6\n", ("a",), "", None, [[5, 6]]),
}  # fmt: skip
REFUSED = {
    "plotter_two.log": ("a:1,2\na:3,5\n", "2 values but the labels a"),
    "plotter_cut.log": ("7,b:2\na:1,b:2\na:3,b:5\n", "line 1: '7,b:2' has other labels than a, b"),
    "plotter_end.log": ("a:1,b:2\na:3,b:5\na:4\n", "line 3: 'a:4' has other labels than a, b"),
    "english.csv": ('t (ms),n\n0,"1,234"\n1,"2,345"\n', "line 2: the comma of '1,234' may be"),
    "swiss.csv": ("a;b\n1'234.5;2\n1'999.5;3\n", "line 2: a is '1'234.5', no number"),
    "french.csv": ("a;b\n1 234,5;2\n1 999,5;3\n", "line 2: a is '1 234,5', no number"),
    "units.csv": ("a,b\n1.5 V,2\n1.6 V,3\n", "line 2: a is '1.5 V', no number"),
    "remark.csv": ("a,b\n1,2 # of a cell\n2,3 # too\n", "line 2: b is '2 # of a cell', no number"),
    "hex.csv": ("a,b\n1,0x1F\n2,0x20\n", "line 2: b is '0x1F', no number"),
    "json.txt": ('{"a":[1,2,3]}\n', "no rows of numbers"),
    "long.txt": ("samp" * 50_000, "no rows of numbers"),  # in a moment, too
    "two_times.csv": ("Trigger [s],Time [s],Ch0\n0.0,0.0,1200.5\n0.0625,0.0625,1400\n", "2 columns of times"),
    "digital.csv": ("Time [s],Channel 0\n0.0,0\n0.125,1\n0.25,0\n1.0,1\n", "uneven"),
    "missing.csv": ("Time [s],Ch0,Ch1\n0.0,1,\n0.1,2,3\n", "line 2: Ch1 has no value"),
    "gap.csv": ("Time [s],Ch0\n0.0,1\n0.1,X\n", "line 3: Ch0 is 'X', no number"),
    "over.csv": ("Time,Channel A\n(ms),(V)\n\n0,1\n1,∞\n2,1\n", "line 5: Channel A is '∞'"),
    "nan.csv": ("a,b\n1,2\n3,nan\n", "b is NaN in row 2"),
    "lost.csv": ("Time (s),x\n0.0,1\n0.1,2\n0.2,3\n0.4,5\n0.5,6\n", "after row 3"),
    "lost_index.csv": ("seq,x\n0,1\n1,2\n3,3\n", "rows are missing"),
    "back.csv": ("Time (s),x\n0.0,1\n0.1,2\n0.0,3\n", "does not rise: row 3"),
    "mixed.csv": ("a;b\n1;2\n3,5\n", "line 3: a comma separates its values, a semicolon those before"),
    "signs.csv": ("a;b\n1,5;2\n2.5;3\n", "which of them is the decimal sign"),
    "thousands.csv": ("a;b\n1.234,5;2\n", "which of them is the decimal sign"),
    "decimal.csv": ("Vc\n1,5\n2,5\n", "if the comma is their decimal sign"),
    "short.csv": ("a,b,c\n1,2,3\n4,5\n", "line 3: 2 values where the rows before have 3"),
    "reset.csv": ("a,b\n1,2\na,b\n3,4\n", "line 3: 'a,b' is text among the numbers"),
    "error.csv": ("a,b\n1,err\n2,3\n", "line 2: '1,err' has text among numbers"),
    "labels.log": ("a:1,b:2\na:1,c:2\na:3,b:4\n", "other labels than a, b"),
    "names.csv": ("a,b\n1,2,3\n", "line 2: 3 values under the 2 names of line 1"),
    "only_time.csv": ("Time (s)\n0.0\n0.1\n", "no channel, only Time"),
    "empty.csv": ("\n# nothing\n", "empty"),
    "words.csv": ("name,colour\nrubber,black\n", "no rows of numbers"),
    "wide.csv": (",".join(["1"] * 1_000_000) + "\n", "1000000 columns, more than the core's 4096"),
    "wide_names.csv": (",".join("abcde" * 1000) + "\n1,2\n", "5000 columns"),
    "page.pdf": ("%PDF-1.4\n", ".csv"),
    "binary.csv": ("\x93NUMPY\x01\x00", "not text"),
    "not.wav": ("RIFF no", "not.wav"),
    "not.mat": ("MATLAB 5.0 no", "not.mat"),
    "not.sr": ("PK no", "not.sr"),
    "not.mcap": ("\x89MCAP0 no", "not.mcap"),
    "not.npz": ("PK no", "not.npz"),
    "not.h5": ("HDF no", "not.h5"),
    "not.tdms": ("TDSm no", "not.tdms"),
    "not.bag": ("#ROSBAG no", "not.bag"),
}


@pytest.mark.parametrize("name", EVEN)
def test_what_tools_write(tmp_path, name):
    text, names, unit, rate, values = EVEN[name]
    (tmp_path / name).write_text(text, "utf-8")
    found = readers.read(tmp_path / name)
    assert (found.names, found.unit) == (names, unit)
    assert found.rate_hz == (None if rate is None else pytest.approx(rate, rel=2e-3))
    assert found.values.tolist() == values


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(tmp_path, name):
    text, words = REFUSED[name]
    (tmp_path / name).write_bytes(text.encode("latin-1" if text.isascii() or "\x93" in text else "utf-8"))
    with pytest.raises(ValueError) as problem:
        readers.read(tmp_path / name).scaled()
    sentence = str(problem.value)
    assert words in sentence and name in sentence and "\n" not in sentence and len(sentence) < 400


@pytest.mark.parametrize("kind", ["utf-16", "cp1252", "utf-8-sig"])
def test_encodings_of_spreadsheets(tmp_path, kind):
    (tmp_path / "IN.CSV").write_bytes("Zeit (µs);Druck (mV)\r\n0;1,5\r\n100;2,5\r\n".encode(kind))
    found = readers.read(tmp_path / "IN.CSV")
    assert (found.names, found.rate_hz) == (("Druck",), 1e4)
    assert found.values.tolist() == pytest.approx(np.array([[0.0015, 0.0025]]))


def test_what_was_taken_is_one_line(tmp_path):
    (tmp_path / "pico.csv").write_text(EVEN["pico_de.csv"][0], "utf-8")
    said = readers.read(tmp_path / "pico.csv").said
    assert said == (
        f"{tmp_path}/pico.csv: semicolon, decimal comma; 3 rows of Kanal A in V; Zeit left out, times in us; "
        "20000 Hz from Zeit"
    )
    (tmp_path / "r.csv").write_text(EVEN["rising.csv"][0])
    (tmp_path / "w.csv").write_text(EVEN["text.csv"][0])
    assert "decimal comma, without the text of when, without the text of finger; " in (
        readers.read(tmp_path / "w.csv").said
    )
    assert "column 1 left out, as it rises in equal steps of 1 (--column takes it)" in (
        readers.read(tmp_path / "r.csv").said
    )


def test_the_options_decide_where_the_file_does_not(tmp_path):
    """Columns by name, in another order, and by number; a rate in place of uneven or two times; a unit."""
    path = tmp_path / "a.csv"
    path.write_text("Time (s),x,a,b (A)\n0.0,1,2,7\n0.1,3,5,8\n0.5,4,6,9\n")
    take = lambda **given: readers.read(path, **given)
    with pytest.raises(ValueError, match="uneven"):
        take()
    with pytest.raises(ValueError, match="are in A, no unit"):
        take(rate=30)
    found = take(rate=30, column=["a,x"])
    assert (found.names, found.rate_hz, found.values.tolist()) == (("a", "x"), 30, [[2, 5, 6], [1, 3, 4]])
    assert take(rate=30, column=["3", "x"]).names == ("a", "x")
    assert take(rate=30, unit="codes").unit == "codes"
    millivolts = take(rate=30, unit="mV", column=["b"])
    assert (millivolts.unit, millivolts.values.tolist()) == ("V", [[0.007, 0.008, 0.009]])
    for given, words in (
        ({"column": ["time"]}, "Time is no channel"),
        ({"column": ["c"]}, "no column 'c'; it has Time, x, a, b"),
        ({"column": ["5"]}, "no column '5'"),
        ({"column": ["a"], "rate": 0.0}, "rate = 0"),
        ({"column": ["a"], "rate": 5, "shape": (2, 2)}, "1 channels, not the 4 of 2×2"),
    ):
        with pytest.raises(ValueError, match=words):
            take(**given)
    with pytest.raises(ValueError, match=r"b is in A; .*--unit"):
        take(rate=30, column=["b"]).scaled()
    frames = take(rate=30, column=["x,a,x,a"], shape=(2, 2))
    assert frames.values.tolist() == [[[1, 2], [1, 2]], [[3, 5], [3, 5]], [[4, 6], [4, 6]]]


def test_volts_become_codes(tmp_path):
    """0.25 V a code, rounded half up; a converter of 3 bits from 0 to 2 V cuts at its ends and says so."""
    path = tmp_path / "v.csv"
    path.write_text("t (s),a (V)\n" + "".join(f"{k / 10},{v}\n" for k, v in enumerate(VOLTS)))
    found = readers.read(path)
    codes, said = found.scaled(volts_per_code=0.25)
    assert codes.tolist() == [[0, 0, 1, 1, -2, 8, 9]] and "codes of 0.25 V" in said
    codes, said = found.scaled(converter=Adc(3, 0.0, 2.0))
    assert codes.tolist() == [[0, 0, 1, 1, 0, 7, 7]]
    assert "2 beyond its range cut to its ends" in said
    with pytest.raises(
        ValueError, match=r"a in volts; give the converter with --config, or --volts-per-code"
    ):
        found.scaled()
    with pytest.raises(ValueError, match="volts-per-code = 0"):
        found.scaled(volts_per_code=0.0)
    path.write_text("a\n1.5\n2\n")
    with pytest.raises(ValueError, match=r"no unit and are not integers, such as 1\.5"):
        readers.read(path).scaled()
    assert readers.read(path).scaled(0.5)[0].tolist() == [[3, 4]]
    path.write_text("a (counts)\n1\n2\n")
    with pytest.raises(ValueError, match="codes already"):
        readers.read(path).scaled(0.5)
    path.write_text("a\n1\n8\n")
    with pytest.raises(ValueError, match=r"1 \.\. 8, outside 0 \.\. 7"):
        readers.read(path).scaled(converter=Adc(3, 0.0, 2.0))


VOLTS = (0.0, 0.124, 0.125, 0.374, -0.376, 2.0, 2.25)


def test_arrays(tmp_path):
    """npy and npz are [channels, samples]; MATLAB's have their time along the longer side."""
    x = np.array([[3, 1, 4, 1, 5], [9, 2, 6, 5, 3]])
    np.save(tmp_path / "a.npy", x)
    np.savez(tmp_path / "b.npz", x=x, fs=250.0)
    np.savez(tmp_path / "c.npz", left=x[0], right=x[1], time_ms=np.arange(5) * 2.0)
    np.savez(tmp_path / "d.npz", grasp1=x[0], grasp2=x[1, :3])
    scipy.io.savemat(tmp_path / "e.mat", {"data": x.T, "Fs": 125.0, "note": "of rubber"})
    scipy.io.savemat(tmp_path / "f.mat", {"t": np.arange(5) / 50, "left": x[0], "right": x[1]})
    for name, names, rate in (
        ("a.npy", ("samples 1", "samples 2"), None),
        ("b.npz", ("x 1", "x 2"), 250),
        ("c.npz", ("left", "right"), 500),
        ("e.mat", ("data 1", "data 2"), 125),
    ):
        found = readers.read(tmp_path / name)
        assert (found.names, found.values.tolist()) == (names, x.tolist())
        assert found.rate_hz == (None if rate is None else pytest.approx(rate))
    assert readers.read(tmp_path / "f.mat").rate_hz == pytest.approx(50)
    assert readers.read(tmp_path / "a.npy", samples_first=True).values.tolist() == x.T.tolist()
    with pytest.raises(ValueError, match=r"grasp1 \[5\], grasp2 \[3\]: choose with --column"):
        readers.read(tmp_path / "d.npz")
    assert readers.read(tmp_path / "d.npz", ["grasp2"]).values.tolist() == [[9, 2, 6]]
    np.save(tmp_path / "ramp.npy", np.stack([np.arange(5), x[0]]))
    found = readers.read(tmp_path / "ramp.npy")
    assert found.values.tolist() == [x[0].tolist()] and "samples 1 left out" in found.said
    assert len(readers.read(tmp_path / "ramp.npy", ["1,2"]).values) == 2
    rows = np.array([(0, 5.5), (1, 6.5)], dtype=[("index", "i4"), ("Vc_mV", "f8")])
    np.save(tmp_path / "rows.npy", rows)
    found = readers.read(tmp_path / "rows.npy")
    assert (found.names, found.unit, found.values.tolist()) == (("Vc",), "V", [[0.0055, 0.0065]])
    scipy.io.savemat(tmp_path / "g.mat", {"note": "nothing"})
    with pytest.raises(ValueError, match=r"g\.mat has no channel, only MATLAB 5 with note \(<U1\)"):
        readers.read(tmp_path / "g.mat")
    assert readers.read(tmp_path / "c.npz", ["right,left"]).values.tolist() == x[::-1].tolist()
    with pytest.raises(ValueError, match="no column 'middle'; it has left"):
        readers.read(tmp_path / "c.npz", ["left,middle"])
    scipy.io.savemat(tmp_path / "h.mat", {"run": {"vc": x[0], "t": np.arange(5) / 8, "gain": 2.0}})
    found = readers.read(tmp_path / "h.mat")
    assert (found.names, found.rate_hz) == (("run.vc",), 8) and found.values.tolist() == [x[0].tolist()]
    damaged = bytearray((tmp_path / "f.mat").read_bytes())
    damaged[128 + 48] = 250  # the type of the numbers of t, with which SciPy 1.17 ends by a signal
    (tmp_path / "i.mat").write_bytes(damaged)
    with pytest.raises(ValueError, match=r"i\.mat is not a complete \.mat file"):
        readers.read(tmp_path / "i.mat")
    np.save(tmp_path / "o.npy", np.array([{}, None]), allow_pickle=True)  # may run code
    with pytest.raises(ValueError, match=r"o\.npy is not a \.npy file of numbers"):
        readers.read(tmp_path / "o.npy")


def wav(samples, rate, bits=16, kind=1):
    """A WAV file by its published layout: ``samples`` [frames, channels]."""
    if bits == 24:
        body = b"".join(int(value).to_bytes(3, "little", signed=True) for value in np.ravel(samples))
    else:
        body = np.asarray(samples, f"<i{bits // 8}" if kind == 1 else "<f4").tobytes()
    channels = np.shape(samples)[1]
    block = channels * bits // 8
    head = b"fmt " + struct.pack("<IHHIIHH", 16, kind, channels, rate, rate * block, block, bits)
    data = b"WAVE" + head + b"data" + struct.pack("<I", len(body)) + body
    return b"RIFF" + struct.pack("<I", len(data)) + data


def test_a_wav_says_neither_volts_nor_codes(tmp_path):
    """Of music or of a sensor: only its user knows."""
    path = tmp_path / "a.wav"
    path.write_bytes(wav([[1, -2], [300, -400], [5, 6]], 44100))
    found = readers.read(path)
    assert (found.rate_hz, found.values.tolist()) == (44100, [[1, 300, 5], [-2, -400, 6]])
    with pytest.raises(
        ValueError, match=r"2 channels of int16 at 44100 Hz.*shares of full scale.*--unit codes"
    ):
        found.scaled()
    with pytest.raises(ValueError, match="shares of full scale"):
        found.scaled(volts_per_code=0.1)
    assert readers.read(path, unit="codes").scaled()[0].tolist() == [[1, 300, 5], [-2, -400, 6]]
    for bits in (24, 32):
        path.write_bytes(wav([[1, -2], [300, -400], [5, 6]], 44100, bits))
        found = readers.read(path, unit="codes")
        assert found.scaled()[0].tolist() == [[1, 300, 5], [-2, -400, 6]]
        path.write_bytes(path.read_bytes()[: -2 * bits // 8])
        with pytest.raises(ValueError, match=r"a\.wav is not a complete .* EOF"):
            readers.read(path, unit="codes")
    path.write_bytes(wav([[0.5], [-0.25]], 8000, 32, 3))
    assert readers.read(path, unit="V").scaled(0.25)[0].tolist() == [[2, -1]]


def session(path, metadata, **parts):
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("version", "2")
        file.writestr("metadata", metadata)
        for name, values in parts.items():
            file.writestr(name.replace("_", "-"), struct.pack(f"<{len(values)}f", *values))


DEVICE = (
    "[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\ntotal probes=1\nsamplerate=20 kHz\n"
)
DEVICE += "total analog=2\nprobe1=D0\nanalog2=CH1\nanalog3=CH2\nunitsize=1\n"


def test_a_sigrok_session(tmp_path):
    """Analog channels are numbered after the probes; their parts follow each other, 10 after 9."""
    path = tmp_path / "a.sr"
    parts = {f"analog_1_3_{k}": [k / 4] for k in range(1, 12)}
    session(path, DEVICE, logic_1_1=[0.0] * 3, analog_1_2_1=[k / 8 for k in range(11)], **parts)
    found = readers.read(path)
    assert (found.names, found.unit, found.rate_hz) == (("CH1", "CH2"), "V", 20e3)
    assert found.values.tolist() == [[k / 8 for k in range(11)], [k / 4 for k in range(1, 12)]]
    session(path, DEVICE, logic_1_1=[0.0])
    with pytest.raises(ValueError, match="logic capture of 1 probes without an analog channel"):
        readers.read(path)
    session(path, DEVICE, analog_1_2_1=[1.0], analog_1_2_3=[1.0])
    with pytest.raises(ValueError, match="a part of channel 2 is missing"):
        readers.read(path)


ARRAY = "std_msgs/MultiArrayLayout layout\nint32[] data\n" + "=" * 80 + "\nMSG: std_msgs/MultiArrayLayout\n"
ARRAY += "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n" + "=" * 80
ARRAY += "\nMSG: std_msgs/MultiArrayDimension\nstring label\nuint32 size\nuint32 stride\n"


def cdr_array(values):
    """std_msgs/Int32MultiArray without dimensions, serialised by hand: CDR, little-endian."""
    return struct.pack(f"<4xIII{len(values)}i", 0, 0, len(values), *values).replace(
        b"\0\0\0\0", b"\0\1\0\0", 1
    )


def bag_of(path, topics, encoding="cdr"):
    """An MCAP file by the library of its format; ``topics``: {topic: (type, definition, [(ns, bytes)])}."""
    from mcap.writer import Writer

    with open(path, "wb") as file:
        writer = Writer(file)
        writer.start()
        for topic, (kind, text, messages) in topics.items():
            schema = writer.register_schema(
                kind, "ros2msg" if encoding == "cdr" else "jsonschema", text.encode()
            )
            channel = writer.register_channel(topic, encoding, schema)
            for stamp, data in messages:
                writer.add_message(channel, stamp, data, stamp)
        writer.finish()


def test_an_mcap_of_any_robot(tmp_path):
    path, kind = tmp_path / "a.mcap", "std_msgs/msg/Int32MultiArray"
    rows = [(10**9 + 4_000_000 * k, cdr_array([k * k, 7 - k, 5])) for k in range(4)]
    text = ("std_msgs/msg/String", "string data", [(5, b"\0\1\0\0\3\0\0\0hi\0")])
    bag_of(path, {"/touch": (kind, ARRAY, rows), "/note": text})
    found = readers.read(path)
    assert found.values.tolist() == [[0, 1, 4, 9], [7, 6, 5, 4], [5, 5, 5, 5]]
    assert found.rate_hz == pytest.approx(250) and "topic /touch" in found.said
    bag_of(path, {"/touch": (kind, ARRAY, rows), "/other": (kind, ARRAY, rows[:2])})
    with pytest.raises(ValueError, match=r"numbers in /touch, /other: choose one with --column"):
        readers.read(path)
    assert readers.read(path, ["/other"]).values.shape == (3, 2)
    np.save(tmp_path / "n.npy", [0.0, 1.5])
    codes, *_ = calibration.read_recording(path, tmp_path / "n.npy", column=["/other"], shape=(1, 3))
    assert codes.tolist() == [[[0, 7, 5]], [[1, 6, 5]]]
    bag_of(path, {"/touch": (kind, ARRAY, [*rows, (2 * 10**9, cdr_array([1]))])})
    with pytest.raises(ValueError, match="change their size"):
        readers.read(path)
    bag_of(path, {"/touch": (kind, ARRAY, rows[::-1])})  # as several threads may write it
    assert readers.read(path).values[0].tolist() == [0, 1, 4, 9]
    with pytest.raises(ValueError, match="no topic with numbers '/touh'; without --column: MCAP, topic /to"):
        readers.read(path, ["/touh"])
    cdr = b"\0\1\0\0"
    octets = [(5 + k, cdr + struct.pack("<I3B", 3, k, 7, 200 + k)) for k in range(2)]
    camera = ("a/msg/CompressedImage", "string format\nuint8[] data", [(9, cdr + bytes(12))])
    bag_of(path, {"/touch": ("a/msg/Octets", "uint8[] data", octets), "/camera": camera})
    assert readers.read(path).values.tolist() == [[0, 1], [7, 7], [200, 201]]
    force = [(5 + k, cdr + struct.pack("<I4xdd", k, k / 4, -k)) for k in range(3)]
    bag_of(path, {"/force": ("a/msg/Force", "uint32 seq\nfloat64 x\nfloat64 y", force)})
    with pytest.raises(ValueError, match=r"numbers in /force\.x, /force\.y: choose"):
        readers.read(path)
    found = readers.read(path, ["/force.y,/force.x"])
    assert (found.names, found.values.tolist()) == (("/force.y", "/force.x"), [[0, -1, -2], [0, 0.25, 0.5]])
    bag_of(path, {"/note": text})
    with pytest.raises(ValueError, match=r"holds no numbers, only /note \(std_msgs/msg/String\)"):
        readers.read(path)
    bag_of(path, {"/note": ("note", "{}", [(5, b"{}")])}, "json")
    with pytest.raises(ValueError, match=r"no ROS 2 messages, only /note \(json\)"):
        readers.read(path)
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(ValueError, match=r"a\.mcap is not a complete"):
        readers.read(path)


def test_an_image_of_any_robot(tmp_path):
    """sensor_msgs/Image, 16 bits, big-endian, with a byte of padding a line; by its header's stamps."""
    from mcap_ros2.writer import Writer  # the library's own serialisation

    text = "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
    text += "uint8 is_bigendian\nuint32 step\n"
    text += (
        "uint8[] data\n"
        + "=" * 80
        + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    )
    text += "=" * 80 + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    with open(tmp_path / "i.mcap", "wb") as file:
        writer = Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/Image", text)
        for k in range(3):
            data = struct.pack(">HHHx", k, 256 + k, 3) + struct.pack(">HHHx", 4, 5, 60000)
            image = {
                "height": 2,
                "width": 3,
                "encoding": "mono16",
                "is_bigendian": 1,
                "step": 7,
                "data": data,
            }
            image["header"] = {"stamp": {"sec": 7, "nanosec": 10_000_000 * k}, "frame_id": "tactile"}
            writer.write_message("/tactile/image", schema, image, log_time=k * k)
        writer.finish()
    found = readers.read(tmp_path / "i.mcap")
    assert found.values.tolist() == [[[k, 256 + k, 3], [4, 5, 60000]] for k in range(3)]
    assert found.rate_hz == pytest.approx(100)
    assert found.flat().values.tolist()[:2] == [[0, 1, 2], [256, 257, 258]]


def test_a_log_of_a_core(tmp_path):
    """Its images: taxels as channels, or as frames of process cop."""
    model = SimulatedCore(size=(2, 3), clk_khz=1000)
    with host.Core(line.Pipe(model)) as core, log.recording(tmp_path / "own.mcap", core) as out:
        for k in range(4):
            model.say(packet.COP, 5000 * k, packet.cop_frame(5, -6, 700, 1))
            for part in packet.image_chunks(k, [100 * k + taxel for taxel in range(6)], 3):
                model.say(packet.IMAGE, 5000 * k, part)
        for item in core.packets(0.05):
            out.add(item)
    found = readers.read(tmp_path / "own.mcap")
    images = [
        [[100 * k, 100 * k + 1, 100 * k + 2], [100 * k + 3, 100 * k + 4, 100 * k + 5]] for k in range(4)
    ]
    assert found.values.tolist() == images and found.rate_hz == pytest.approx(200)
    assert found.flat().values[4].tolist() == [4, 104, 204, 304]


def test_hdf5(tmp_path):
    h5py = pytest.importorskip("h5py")
    x = np.array([[3.5, 1, 4], [1, 5, 9]])
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs["sample_rate"] = 2000.0
        file.create_dataset("run/vc", data=x.T.repeat(2, 0)).attrs["units"] = "mV"
        file.create_dataset("note", data="of rubber")
    found = readers.read(tmp_path / "a.h5")
    assert (found.names, found.unit, found.rate_hz) == (("run/vc 1", "run/vc 2"), "V", 2000)
    assert found.values == pytest.approx(x.repeat(2, 1) / 1000)
    with h5py.File(tmp_path / "a.h5", "a") as file:  # MATLAB 7.3 writes HDF5, and letters as numbers
        file.create_dataset("who", data=np.array([[104], [105]], "u2")).attrs["MATLAB_class"] = "char"
    (tmp_path / "a.h5").rename(tmp_path / "b.mat")
    assert readers.read(tmp_path / "b.mat").values.shape == (2, 6)
    with h5py.File(tmp_path / "c.h5", "w") as file:
        file["run/time"], file["run/vc"] = np.arange(5) / 8, np.arange(5) ** 2
        file["rows"] = np.array([(7, 2.0)] * 5, [("index", "i4"), ("vc", "f8")])
        file["run/time"].attrs["fs"] = 9.0
    found = readers.read(tmp_path / "c.h5")
    assert (found.names, found.rate_hz) == (("rows.index", "rows.vc", "run/vc"), 8)
    with h5py.File(tmp_path / "d.h5", "w") as file:
        file.create_dataset("x", (10**13,), "f8", chunks=(1000,))
    with pytest.raises(ValueError, match=r"d\.h5 would take 80000\.0 GB of memory"):
        readers.read(tmp_path / "d.h5")


def test_tdms(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    made = [
        nptdms.ChannelObject(
            "run", name, np.array(values), properties={"wf_increment": 0.0005, "unit_string": "V"}
        )
        for name, values in (("ai0", [1.5, 2.5]), ("ai1", [3.0, 4.0]))
    ]
    with nptdms.TdmsWriter(tmp_path / "a.tdms") as writer:
        writer.write_segment(made)
    found = readers.read(tmp_path / "a.tdms")
    assert (found.names, found.unit, found.rate_hz) == (("ai0", "ai1"), "V", 2000)
    assert found.values.tolist() == [[1.5, 2.5], [3, 4]]


@pytest.mark.parametrize("version", [1, 2])
def test_bags(tmp_path, version):
    """Bags that rosbags writes: JointState has three arrays; a bag of text alone holds no numbers."""
    typesys = pytest.importorskip("rosbags.typesys")
    from rosbags import rosbag1, rosbag2

    store = typesys.get_typestore(typesys.Stores.ROS1_NOETIC if version == 1 else typesys.Stores.ROS2_HUMBLE)
    kinds = store.types
    head = {"seq": 0} if version == 1 else {}
    time = kinds["builtin_interfaces/msg/Time"]

    def joints(k):
        header = kinds["std_msgs/msg/Header"](**head, stamp=time(3, 20_000_000 * k), frame_id="hand")
        arrays = (np.array([k, 2.0 * k]), np.array([9.0, k]), np.array([]))
        return kinds["sensor_msgs/msg/JointState"](header, ["a", "b"], *arrays)

    for name, kind, messages in (
        ("joints", "sensor_msgs/msg/JointState", [joints(k) for k in range(3)]),
        ("text", "std_msgs/msg/String", [kinds["std_msgs/msg/String"]("hi")]),
    ):
        path = tmp_path / (f"{name}.bag" if version == 1 else name)
        opened = rosbag1.Writer(path) if version == 1 else rosbag2.Writer(path, version=9)
        with opened as writer:
            given = {"typestore": store}
            connection = writer.add_connection("/hand", kind, **given)
            for k, message in enumerate(messages):
                raw = (
                    store.serialize_ros1(message, kind)
                    if version == 1
                    else store.serialize_cdr(message, kind)
                )
                writer.write(connection, 1000 + k, raw)
    joint, text = (tmp_path / (f"{name}.bag" if version == 1 else name) for name in ("joints", "text"))
    with pytest.raises(ValueError, match=r"/hand\.position, /hand\.velocity"):
        readers.read(joint)
    found = readers.read(joint, ["/hand.velocity"])
    assert found.values.tolist() == [[9, 9, 9], [0, 1, 2]] and found.rate_hz == pytest.approx(50)
    with pytest.raises(ValueError, match="holds no numbers, only /hand"):
        readers.read(text)


def test_what_an_extra_installs_is_named(tmp_path, monkeypatch):
    (tmp_path / "a.tdms").write_bytes(b"TDSm")
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(ValueError, match=r"meissner-touch\[formats\]"):
        readers.read(tmp_path / "a.tdms")


def test_the_python_classes_take_recordings(tmp_path):
    """By path or as a Recording: the same as of the array."""
    rng = np.random.default_rng(5)
    x = rng.integers(0, 4096, (2, 300))
    text = "t (ms),a (V),b (V)\n" + "".join(
        f"{k / 10},{p / 1024},{q / 1024}\n" for k, (p, q) in enumerate(x.T)
    )
    (tmp_path / "own.csv").write_text(text)
    slip = meissner.Slip(meissner.SlipConfig(threshold=900), channels=2)
    found = meissner.read(tmp_path / "own.csv")
    with pytest.raises(ValueError, match="in volts"):
        slip.process(found)
    codes = found.scaled(volts_per_code=1 / 1024)[0].astype(int)
    assert np.array_equal(codes, x)
    (tmp_path / "codes.csv").write_text("\n".join(f"{p};{q}" for p, q in x.T))
    for given in (tmp_path / "codes.csv", meissner.read(tmp_path / "codes.csv")):
        for got, wanted in zip(slip.process(given), slip.process(x)):
            assert np.array_equal(got, wanted)
    frames = meissner.read(tmp_path / "codes.csv", shape=(1, 2))
    assert np.array_equal(meissner.Cop().process(frames).sum, x.sum(0))
    assert engines.check_samples(found.scaled(1 / 1024)[0]).dtype == np.int64


def test_memory_is_checked_before_it_is_taken(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_text("1\n")
    monkeypatch.setattr(sys.modules["meissner.readers.table"], "MEMORY_SHARE", 1e-12)
    with pytest.raises(ValueError, match=r"a\.csv would take .* GB of memory"):
        readers.read(path)


def test_the_text_of_a_million_rows_is_read(tmp_path):
    rows = io.StringIO()
    np.savetxt(rows, np.arange(200_000)[:, None] % [7, 11], "%d", ";")
    (tmp_path / "long.tsv").write_text(rows.getvalue())
    found = readers.read(tmp_path / "long.tsv")
    assert found.values.shape == (2, 200_000) and found.values[:, -1].tolist() == [199_999 % 7, 199_999 % 11]
