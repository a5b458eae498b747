"""What structures are made of, as arrays and kernels: cable runs, ties, sheaves, saddles, nets, and places on them."""
