function [result, info] = springs(what, varargin)
% mbk.springs  Subcommands of 'mbk springs': field, find, calibrate.
%
%   [RESULT, INFO] = mbk.springs('field', ..., NAME, VALUE, ...) runs 'mbk springs field'. After the name of the
%   subcommand come data (see 'help mbk.measure'), file names or other words, as a text or a cell array of several,
%   then options with their values. RESULT is the document of --json as a struct, or the text that the command prints.
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run(['springs ' char(what)], varargin);
end
