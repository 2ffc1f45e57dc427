/* report.js - a report: charts from the data inside the file. */
"use strict";
