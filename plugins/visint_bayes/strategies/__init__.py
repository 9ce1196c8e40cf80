"""Other ways to combine cues (chapter 2 of the dissertation), each as a reconciler of all evidence on depth."""
