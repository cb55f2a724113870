"""The commands: thin over the packages, each a file with ``main(arguments)``; installed as ``floquet_scripts``, where
``floquet-charts`` finds them."""
