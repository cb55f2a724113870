"""Is the certificate of a proved chart right? Checked by other code, in other arithmetic.

`check` reads the file that `ProvedChart.save` wrote and says what is wrong with it, or nothing. This package imports
python-flint and Python's own library, and nothing of the rest: it integrates again (`flow`), in balls from the first
number to the last (`arithmetic`, `reading`), with other steps, norms and bounds, and then looks at every cell (`cells`)
and at whether the cells cover the window (`certificate`). docs/certify.md, section 12, has what is checked. From a
shell: ``python -m floquet.certified.checking FILE``.

>>> import tempfile
>>> from floquet.certified import prove_chart
>>> from floquet.certified.checking import check
>>> from periodic.examples import mathieu
>>> with tempfile.TemporaryDirectory() as folder:
...     prove_chart(mathieu(), (1.9, 2.1), (0.0, 0.1), progress=False).save(f"{folder}/chart.npz")
...     check(f"{folder}/chart.npz")
''
"""

from floquet.certified.checking.certificate import check

__all__ = ["check"]
