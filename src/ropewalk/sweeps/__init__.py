"""Many runs: what varies, the engine that computes them side by side, the store, tables and figures of all."""
