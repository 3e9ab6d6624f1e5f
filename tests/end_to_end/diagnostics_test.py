#!/usr/bin/env python3
"""The numbers behind the plots of mbk measure --report, against NumPy and SciPy on the same recording."""

import unittest

from command import Case, main, make_log, run, table_of
from report_test import document_of

try:
    import numpy
    import scipy.signal
    import scipy.stats
except ImportError:
    numpy = scipy = None

DIGITS = 1e-5  # the report holds six


@unittest.skipIf(scipy is None, "NumPy or SciPy is not there")
class Diagnostics(Case):
    def setUp(self):
        super().setUp()
        if "MBK_WEB" in run("measure", "nothing.mat", "--report", self.folder / "no.html").err:
            self.skipTest("this mbk was built without the page")

    def measured(self, log, *options):
        """The preparation and the diagnostics of a log, and its columns as arrays."""
        path = self.folder / "report.html"
        self.fine("measure", log.path, *options, "--report", path, "--overwrite")
        document = document_of(path)
        arrays = [numpy.array(column) for column in table_of(log)]
        return document["result"], document["trials"][0]["diagnostics"], arrays

    def assert_close(self, got, want, tolerance=DIGITS, floor=0.0):
        got, want = numpy.array(got, dtype=float), numpy.array(want)
        off = numpy.abs(got - want) > tolerance * numpy.abs(want) + floor
        self.assertFalse(off.any(), f"{got[off][:5]} is not {want[off][:5]}")

    def test_spectra_and_coherence_are_those_of_scipy(self):
        for options in ([], ["--mode", "reference"], ["--from", "10", "--to", "33.3", "--protocol", "free"]):
            result, found, (time, x, y, force_x, force_y, *_) = self.measured(make_log(), *options)
            spectra, how = found["spectra"], result["preparation"][0]
            rate = 1.0 / numpy.median(numpy.diff(time))
            counts = slice(round(how["from_s"] * rate), round(how["to_s"] * rate) + 1)
            signals = numpy.array([x, y, force_x, force_y])[:, counts]
            segment = round(rate / spectra["frequency_hz"][1])
            self.assertEqual(segment % 2, 0)
            steps = (signals.shape[1] - segment) // (segment // 2)
            self.assertEqual(spectra["segments"], steps + 1)

            lines = len(spectra["frequency_hz"])
            density = numpy.array([[scipy.signal.csd(signals[k], signals[j], rate, "hann", segment, segment // 2)[1]
                                    for k in range(4)] for j in range(4)])[:, :, :lines]
            self.assert_close(spectra["frequency_hz"], numpy.arange(lines) * rate / segment)
            for axis in range(2):
                self.assert_close(spectra["position"][axis], density[axis, axis].real)
                self.assert_close(spectra["force"][axis], density[2 + axis, 2 + axis].real)
                explained = [
                    (cross.conj() @ numpy.linalg.solve(motion, cross)).real
                    for motion, cross in zip(density[:2, :2].transpose(2, 0, 1), density[:2, 2 + axis].T)]
                self.assert_close(spectra["coherence"][axis], explained / density[2 + axis, 2 + axis].real)
            independent = spectra["segments"] / (1 + 2 / 36 * steps / spectra["segments"])
            self.assert_close(spectra["coherence_significant"], scipy.stats.beta(2, independent - 2).isf(0.05))

    def test_filters_have_the_gain_that_scipy_finds(self):
        result, found, (time, *_) = self.measured(make_log(), "--mode", "reference")
        filters, rate = found["filters"], 1.0 / numpy.median(numpy.diff(time))
        frequency = numpy.array(filters["frequency_hz"])
        sections = scipy.signal.butter(5, 5.0, fs=rate, output="sos")
        lowpass = numpy.abs(scipy.signal.sosfreqz(sections, frequency, fs=rate)[1]) ** 2
        for derivative, name in enumerate(["smoothing", "first", "second"]):
            weights = scipy.signal.savgol_coeffs(101, 6, derivative, 1.0 / rate)
            gain = numpy.abs(scipy.signal.freqz(weights, 1, frequency, fs=rate)[1]) * lowpass
            # SciPy's weights of the second derivative sum to some 1e-3 instead of 0; gains are of 1 to 1000.
            self.assert_close(filters[name], gain, 1e-4, floor=0.01 if derivative else 1e-6)

    def test_the_residual_is_what_the_model_leaves(self):
        result, found, _ = self.measured(make_log())
        shown = found["prediction"]
        for axis in range(2):
            measured, residual = (numpy.array(shown[key][axis], dtype=float) for key in ("measured", "residual"))
            vaf = 100 * (1 - numpy.var(residual) / numpy.var(measured))
            self.assertAlmostEqual(vaf, result["fit"]["VAF"][axis], places=3)
            self.assert_close(shown["predicted"][axis], measured - residual, 2 * DIGITS, floor=2e-5)

    def test_the_recording_is_drawn_from_its_extremes(self):
        _, found, (_, x, _, force_x, force_y, *_) = self.measured(make_log())
        drawn = found["recording"]
        for shown, recorded in ((drawn["position"][0], x), (drawn["force"][0], force_x), (drawn["force"][1], force_y)):
            self.assert_close([min(shown), max(shown)], [recorded.min(), recorded.max()])


if __name__ == "__main__":
    main()
