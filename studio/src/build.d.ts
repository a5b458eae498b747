/** Whether a build can draw in space: single files for what stays in a plane cannot, and are small. */
declare const SPACE: boolean;
