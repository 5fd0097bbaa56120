import sys

from .land import main

sys.exit(main())
