# SPDX-License-Identifier: GPL-3.0-or-later
"""German, of the texts between a file and a lit isosurface."""

MESSAGES = {
    # File > Import, and the file dialog.
    "Import Volume": "Volumen importieren",
    "Volume for Leaflight (.nii, .nrrd, .dcm, .tif, .raw, ...)": (
        "Volumen für Leaflight (.nii, .nrrd, .dcm, .tif, .raw, ...)"
    ),
    "Example for Leaflight": "Beispiel für Leaflight",
    "Open Example": "Beispiel öffnen",
    "Compute an example volume and import it": "Ein Beispielvolumen berechnen und importieren",
    "Hydrogen Atom": "Wasserstoffatom",
    "The electron in the state 3d: two lobes and a ring": (
        "Das Elektron im Zustand 3d: zwei Keulen und ein Ring"
    ),
    "Neuron": "Nervenzelle",
    "A cell with branching dendrites": "Eine Zelle mit verzweigten Dendriten",
    "Nuclei": "Atomkerne",
    "Protons in the crust of a neutron star": "Protonen in der Kruste eines Neutronensterns",
    "Particle": "Teilchen",
    "A dirt particle of dented outline": "Ein Schmutzteilchen mit eingedelltem Umriss",
    "Splash": "Spritzer",
    "Water that a laser pulse throws up": "Wasser, das ein Laserpuls hochschleudert",
    "Bump Box": "Bump-Box",
    "The reference volume of the thesis": "Das Referenzvolumen der Dissertation",
    "Read a scalar volume and show one of its isosurfaces": (
        "Ein skalares Volumen lesen und eine seiner Isoflächen zeigen"
    ),
    "All Files": "Alle Dateien",
    "Size From": "Größe aus",
    "Fit": "Einpassen",
    "Life Size": "Lebensgröße",
    "Together With": "Zusammen mit",
    "By Size": "Nach der Größe",
    "Half": "Halbe",
    "Quarter": "Viertel",
    "Automatic": "Automatisch",
    "As in the File": "Wie in der Datei",
    "The file has no orientation": "Die Datei hat keine Ausrichtung",
    "As Animation": "Als Animation",
    "Own Voxel Size": "Eigene Voxelgröße",
    "Voxel Size": "Voxelgröße",
    "Byte Order": "Bytereihenfolge",
    "Several volumes: choose one": "Mehrere Volumen: eines wählen",
    "Frame (0 to %d)": "Bild (0 bis %d)",
    "Channel (0 to %d)": "Kanal (0 bis %d)",
    "Level (0 to %d)": "Stufe (0 bis %d)",
    "%s voxels, %s": "%s Voxel, %s",
    "Read as %s voxels": "Gelesen als %s Voxel",
    "Memory: %s": "Speicher: %s",
    # The strip above the viewport.
    "Isovalue": "Isowert",
    "Stage": "Bühne",
    "Choose objects around the volumes": "Objekte um die Volumen wählen",
    "Keep Bake": "Licht behalten",
    "Throw Away": "Verwerfen",
    # The sidebar.
    "Frame Isosurface": "Isofläche einrahmen",
    "Grid and Outlines": "Raster und Umrisse",
    "Up": "Oben",
    "Front": "Vorne",
    "Turn 90 Degrees": "Um 90 Grad drehen",
    "The file has no orientation: choose Up and Front": (
        "Die Datei hat keine Ausrichtung: Oben und Vorne wählen"
    ),
    "All Channels": "Alle Kanäle",
    "As RGB": "Als RGB",
    "Channel %d": "Kanal %d",
    "%s channel %d": "%s Kanal %d",
    "In the colors of the picture": "In den Farben des Bildes",
    "Labels as Surfaces": "Bezeichnungen als Flächen",
    "Label Table": "Tabelle der Bezeichnungen",
    "Read Label Table": "Tabelle der Bezeichnungen lesen",
    "Show Labels": "Bezeichnungen zeigen",
    "Only Active": "Nur die aktive",
    "Choose a label map as Color By first": (
        "Erst ein Volumen mit Bezeichnungen als Farbe nach wählen"
    ),
    "Both Signs": "Beide Vorzeichen",
    "Color By": "Farbe nach",
    "Color Map": "Farbskala",
    "Cut Data": "Daten schneiden",
    "Bake the Cut": "Schnitt beleuchten",
    "Light near the cut is an estimate": "Das Licht am Schnitt ist geschätzt",
    "Clean Data": "Daten säubern",
    "Mask Data": "Daten maskieren",
    "Within Labels": "Innerhalb von Labels",
    "Crop": "Zuschnitt",
    "Crop to Isosurface": "Auf die Isofläche zuschneiden",
    "cropped": "zugeschnitten",
    "Cropped to %s voxels": "Zugeschnitten auf %s Voxel",
    "Remove Part": "Teil entfernen",
    "Largest Part": "Größter Teil",
    "Removed Part": "Entfernter Teil",
    "Removed Dust": "Entfernter Staub",
    "Parts Moved Apart": "Auseinandergerückte Teile",
    "Move Parts in Data": "Teile in den Daten verschieben",
    "%s at %s": "%s bei %s",
    "Remove Sphere": "Kugel entfernen",
    "Removed Sphere": "Entfernte Kugel",
    "Remove a sphere about the 3D cursor from the data, with its shadow. Shift and the right mouse "
    "button put the cursor on a surface": (
        "Eine Kugel um den 3D-Cursor aus den Daten entfernen, mit ihrem Schatten. Umschalt und die "
        "rechte Maustaste setzen den Cursor auf eine Fläche"
    ),
    "Radius of the sphere in the unit of the data; 0 is a tenth of the volume": (
        "Radius der Kugel in der Einheit der Daten; 0 ist ein Zehntel des Volumens"
    ),
    "sphere removed": "Kugel entfernt",
    "Click on the part to remove. Esc: cancel": "Teil anklicken, der weg soll. Esc: abbrechen",
    "cut; bake to light the cut": "geschnitten; zum Beleuchten des Schnitts backen",
    "small parts removed": "kleine Teile entfernt",
    "masked; bake again": "maskiert; neu backen",
    "part removed": "Teil entfernt",
    "parts moved; bake to light them": "Teile verschoben; zum Beleuchten backen",
    "data changed": "Daten geändert",
    "Reversed": "Umgekehrt",
    "Symmetric": "Symmetrisch",
    "Steps": "Stufen",
    "Color Bar": "Farbbalken",
    "Float": "Schweben",
    "Gradient": "Steigung",
    "Height": "Höhe",
    "Slices on Cuts": "Schichten auf Schnitten",
    "No capped cut: use Cut Data": "Kein geschlossener Schnitt: Daten schneiden",
    "Smooth: %s voxels": "Geglättet: %s Voxel",
    "Smooth Normals: %s": "Normalen geglättet: %s",
    "Pick in Histogram": "Im Histogramm wählen",
    "Looking at the data": "Die Daten werden angesehen",
    "Baked (%d of %d frames)": "Beleuchtet (%d von %d Bildern)",
    "Not baked (%d of %d frames are)": "Nicht beleuchtet (%d von %d Bildern sind es)",
    "Bake All Frames": "Alle Bilder beleuchten",
    "Lowest": "Niedrigster",
    "Highest": "Höchster",
    "Light the Walls": "Wände beleuchten",
    "Both Sides": "Beide Seiten",
    "Draft": "Entwurf",
    "Good": "Gut",
    "Final": "Endgültig",
    "Custom: %s %%": "Eigener Fehler: %s %%",
    "Estimate": "Schätzen",
    "About %s and %s to %s %%": "Etwa %s und %s bis %s %%",
    "Stopped: estimated error %s %% (target %s %%)": (
        "Angehalten: geschätzter Fehler %s %% (Ziel %s %%)"
    ),
    "Live": "Mitgehend",
    "Update the light while lamps, walls, volumes and clip boxes move: direct light at once, "
    "indirect light by the passes of a new bake. The last pass is saved to a new file": (
        "Das Licht anpassen, während sich Lampen, Wände, Volumen und Schnittquader bewegen: "
        "direktes Licht sofort, indirektes durch die Durchgänge einer neuen Berechnung. Der "
        "letzte wird in einer neuen Datei gespeichert"
    ),
    "Stopped: direct light is current, indirect light is of an earlier position": (
        "Angehalten: direktes Licht ist aktuell, indirektes Licht von einer früheren Lage"
    ),
    "Baked in %s s": "In %s s beleuchtet",
    "Quality: %s": "Qualität: %s",
    "Estimated error %s %% (target: %s)": "Geschätzter Fehler %s %% (Ziel: %s)",
    "Lamps have changed since the bake: their light is scaled, which is exact": (
        "Lampen sind seit dem Beleuchten geändert: ihr Licht ist genau angepasst"
    ),
    "Lamps have changed since the bake: direct light is exact, indirect light is scaled": (
        "Lampen sind seit dem Beleuchten geändert: direktes Licht ist genau, indirektes geschätzt"
    ),
    "Hidden: %s": "Ausgeblendet: %s",
    "Show Hidden": "Ausgeblendete zeigen",
    "Isosurfaces": "Isoflächen",
    "Capped": "Geschlossen",
    "Hide Dust": "Staub ausblenden",
    "Explode": "Auseinanderziehen",
    "Closed": "Geschlossen",
    "Distance": "Abstand",
    "Parts as they are in the data": "Teile wie in den Daten",
    "Move connected parts apart along an axis of the data. Each keeps its baked light, that of the "
    "closed arrangement": (
        "Zusammenhängende Teile entlang einer Achse der Daten auseinanderziehen. Jedes behält sein "
        "berechnetes Licht, das der geschlossenen Anordnung"
    ),
    "Distance by which the two outermost parts move apart, in the unit of the data. The parts "
    "between move in proportion": (
        "Abstand, um den die beiden äußersten Teile auseinanderrücken, in der Einheit der Daten. "
        "Die Teile dazwischen rücken im Verhältnis"
    ),
    "Gloss": "Glanz",
    "Slices": "Schnitte",
    "Sagittal": "Sagittal",
    "Coronal": "Koronal",
    "Axial": "Axial",
    "Inside Only": "Nur innen",
    "Lit Wipe": "Beleuchteter Schnitt",
    "Cut of the data through the isosurface from one side to the other. Bake All Frames lights "
    "each frame; before, light near the cut is an estimate": (
        "Schnitt der Daten durch die Isofläche von einer Seite zur anderen. Alle Bilder beleuchten "
        "berechnet jedes Bild; bis dahin ist das Licht am Schnitt geschätzt"
    ),
    "Orientation Cube": "Orientierungswürfel",
    "Bakes: %s": "Beleuchtungen: %s",
    "Bakes: %s (unused: %s)": "Beleuchtungen: %s (unbenutzt: %s)",
    # Why a button is grayed.
    "Leave Edit Mode first": "Erst den Bearbeitungsmodus verlassen",
    "Leaflight is busy; Esc stops it": "Leaflight arbeitet; Esc hält es an",
    "Select or import a volume first (File > Import > Volume for Leaflight)": (
        "Erst ein Volumen auswählen oder importieren (Datei > Importieren > Volumen für Leaflight)"
    ),
}
