"""``python -m floquet.certified.checking FILE``: exit status 0 if the certificate is right, else 1 and why."""

import sys

from floquet.certified.checking import check

wrong = check(sys.argv[1])
print(f"refused: {wrong}" if wrong else "every claim of the certificate was checked and holds")
sys.exit(bool(wrong))
