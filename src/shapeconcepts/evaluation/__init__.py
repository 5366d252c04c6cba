"""The paper's experiments, and strong baselines, on labelled scans."""
