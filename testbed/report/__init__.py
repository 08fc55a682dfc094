"""The report of a diagnosis: one page that opens anywhere, now and in ten years."""

from testbed.report.provenance import Provenance, provenance
from testbed.report.write import write_report

__all__ = ["Provenance", "provenance", "write_report"]
